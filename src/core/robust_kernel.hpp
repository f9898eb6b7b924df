// The robust kernel of all registrations.
// Geman and McClure, "Statistical methods for tomographic image reconstruction", Bulletin of the ISI, 1987.
#pragma once

#include <cmath>

namespace fail_aware {

/// Weight of a residual in iteratively reweighted least squares: 1 at zero, 1/4 at the scale. Both arguments are
/// squared and have the same unit.
inline double gemanMcClureWeight(double squared_residual, double squared_scale) {
  const double kernel = squared_scale / (squared_scale + squared_residual);
  return kernel * kernel;
}

/// Derivative of the weighted residual along a direction, over the weight: 1 at zero, below 0 from scale / sqrt(3) on.
/// `squared_cosine`: of the angle between the residual and the direction.
inline double gemanMcClureCurvature(double weight, double squared_cosine) {
  return 1.0 - 4.0 * (1.0 - std::sqrt(weight)) * squared_cosine;
}

}  // namespace fail_aware
