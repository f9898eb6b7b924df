// The error of an implausible motion (estimation/consistency_monitor.hpp). The map gets it, too, so that no later
// registration takes it back.
#pragma once

#include <cmath>

#include "core/geometry/pose.hpp"

namespace fail_aware {

/// Standard deviations; 0: the motion is plausible.
struct MotionDoubt {
  double sigma_m = 0.0;  ///< along the road and across it
  double sigma_yaw_rad = 0.0;
};

/// Of two errors that know nothing of each other.
inline MotionDoubt sumOf(const MotionDoubt& a, const MotionDoubt& b) {
  return {std::hypot(a.sigma_m, b.sigma_m), std::hypot(a.sigma_yaw_rad, b.sigma_yaw_rad)};
}

/// About the body's axes.
inline Matrix6d covarianceOf(const MotionDoubt& doubt) {
  Vector6d sigmas = Vector6d::Zero();
  sigmas.head<2>().setConstant(doubt.sigma_m);
  sigmas[5] = doubt.sigma_yaw_rad;
  return sigmas.cwiseAbs2().asDiagonal();
}

}  // namespace fail_aware
