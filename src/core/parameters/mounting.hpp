// A sensor's mounting as written in files: six numbers x y z (m), roll pitch yaw (rad) in the vehicle's frame.
#pragma once

#include <string>
#include <vector>

#include "core/geometry/pose.hpp"

namespace fail_aware {

/// Throws ParameterError unless each number is finite and within 100 m and one turn: most mountings in mm or degrees
/// fail this check.
void requireMounting(const char* name, const std::vector<double>& x_y_z_roll_pitch_yaw);

/// A warning for the user if `lidar_in_base` still is the placeholder of cfg/sensors; otherwise empty.
std::string placeholderFault(const std::vector<double>& lidar_in_base);

/// For a list that passes requireMounting().
Pose mountingPose(const std::vector<double>& x_y_z_roll_pitch_yaw);

}  // namespace fail_aware
