// Adds other knowledge of the vehicle's pose to a registered pose: one Kalman update along one direction. Not in the
// paper.
//
// Directions and offsets: x, y, z, roll, pitch, yaw about odom's axes (geometry/pose.hpp's convention), m and rad.
#pragma once

#include "core/types/measurement.hpp"

namespace fail_aware {

/// Update: along `along` the true pose differs from the measured pose by `offset`, with standard deviation `sigma`.
void addOffset(const Vector6d& along, double offset, double sigma, Measurement& measurement);

/// The same for a position along an axis of odom or any other direction of length 1.
void addPosition(const Eigen::Vector3d& axis, double offset_m, double sigma_m, Measurement& measurement);

}  // namespace fail_aware
