// Where a sensor sits, as files say it: six numbers x y z (m), roll pitch yaw (rad) in the vehicle's frame.
#pragma once

#include <vector>

#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"

namespace fail_aware {

/// Throws ParameterError: each number finite, within 100 m and once around (a mounting in mm or in deg is neither).
void requireMounting(const char* name, const std::vector<double>& x_y_z_roll_pitch_yaw);

/// Of a list that requireMounting() takes.
Pose mountingPose(const std::vector<double>& x_y_z_roll_pitch_yaw);

}  // namespace fail_aware
