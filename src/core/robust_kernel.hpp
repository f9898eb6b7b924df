// The robust kernel of all registrations.
// Geman and McClure, "Statistical methods for tomographic image reconstruction", Bulletin of the ISI, 1987.
#pragma once

#include <algorithm>

namespace fail_aware {

/// Weight of a residual in iteratively reweighted least squares: 1 at zero, 1/4 at the scale. Both arguments are
/// squared and have the same unit.
inline double gemanMcClureWeight(double squared_residual, double squared_scale) {
  const double kernel = squared_scale / (squared_scale + squared_residual);
  return kernel * kernel;
}

/// Derivative of the weighted residual along a direction, over the weight: 1 at zero, below 0 from scale / sqrt(3) on.
/// `squared_along`: the residual's component along the direction, squared.
inline double gemanMcClureCurvature(double squared_along, double squared_residual, double squared_scale) {
  return 1.0 - 4.0 * squared_along / (squared_scale + squared_residual);
}

/// Factor on the variance of an estimate from residuals on the kernel's flanks, where a residual pulls no harder
/// the larger it is. `curvature_ratio`: weighted mean of the curvature. An M-estimate's variance grows with its inverse
/// square (Huber, "Robust Statistics", 1981, section 3.2): residuals without a peak at zero agree with every estimate.
/// 1 from `usual_ratio` on; `usual_ratio` 0: always 1.
inline double kernelInflation(double curvature_ratio, double usual_ratio) {
  constexpr double kLeastRatio = 0.02;
  if (usual_ratio <= kLeastRatio) return 1.0;
  const double inflation = usual_ratio / std::min(std::max(curvature_ratio, kLeastRatio), usual_ratio);
  return inflation * inflation;
}

}  // namespace fail_aware
