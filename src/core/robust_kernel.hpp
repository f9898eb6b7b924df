// The robust kernel that all registrations share.
// Geman and McClure, "Statistical methods for tomographic image reconstruction", Bulletin of the ISI, 1987.
#pragma once

namespace fail_aware {

/// Weight of a residual in iteratively reweighted least squares: 1 at zero, 1/4 at the scale. Any unit, squared.
inline double gemanMcClureWeight(double squared_residual, double squared_scale) {
  const double kernel = squared_scale / (squared_scale + squared_residual);
  return kernel * kernel;
}

}  // namespace fail_aware
