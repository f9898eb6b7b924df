// The uncertainty of one sweep's motion: the input of the accumulated covariance (fusion/odometry_covariance.hpp).
// Units: m, rad, s.
#pragma once

#include <optional>

#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"
#include "fail_aware_lidar_odometry/core/types/speed_error.hpp"

namespace fail_aware {

/// Covariances about the previous body's axes.
struct OdometryIncrement {
  Matrix6d covariance = Matrix6d::Zero();
  Matrix6d unobserved = Matrix6d::Zero();  ///< the part of it that stays open (FilterState::unobserved_covariance)
  double dt_s = 0.0;
  SpeedError speed_error;
  bool predicted = false;  ///< the pose is no measurement
  /// Of a measured pose in the map, about odom's axes, where at least two measurements agree on it.
  std::optional<Matrix6d> confirmed{};
  bool map_restarted = false;  ///< with this sweep: measurements refer to the old map no longer
};

}  // namespace fail_aware
