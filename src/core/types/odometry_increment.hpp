// The uncertainty of one sweep's motion: the input of the accumulated covariance (estimation/odometry_covariance.hpp).
// Units: m, rad, s.
#pragma once

#include <optional>

#include "core/geometry/pose.hpp"
#include "core/types/speed_error.hpp"

namespace fail_aware {

/// Covariances about the previous body's axes.
struct OdometryIncrement {
  Matrix6d covariance = Matrix6d::Zero();
  Matrix6d unobserved = Matrix6d::Zero();  ///< the part of it that is not observed (FilterState::unobserved_covariance)
  double dt_s = 0.0;
  SpeedError speed_error;
  bool predicted = false;  ///< the pose is not measured
  /// Covariance of a measured pose in the map, about odom's axes, if at least two measurements agree on the pose.
  std::optional<Matrix6d> confirmed{};
  /// Mean square error of the tilt about odom's axes (VerticalReference::tiltMoment()); none: not known anew.
  std::optional<Eigen::Matrix2d> tilt_moment{};
  bool map_restarted = false;  ///< with this sweep: later measurements do not refer to the old map
};

}  // namespace fail_aware
