// What else is known of the vehicle's place, taken into a registered pose: one Kalman step along one direction.
//
// Directions and offsets: x, y, z, roll, pitch, yaw about odom's axes (geometry/pose.hpp's convention), m and rad.
#pragma once

#include "fail_aware_lidar_odometry/core/types/measurement.hpp"

namespace fail_aware {

/// Along `along` the measured pose is off by `offset`, known to `sigma`.
void addOffset(const Vector6d& along, double offset, double sigma, Measurement& measurement);

/// Likewise, along an axis of odom or any other direction of length 1.
void addPosition(const Eigen::Vector3d& axis, double offset_m, double sigma_m, Measurement& measurement);

}  // namespace fail_aware
