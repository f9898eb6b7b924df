// Where a sensor sits, as files say it: six numbers x y z (m), roll pitch yaw (rad) in the vehicle's frame.
#pragma once

#include <vector>

#include "core/geometry/pose.hpp"

namespace fail_aware {

/// Throws ParameterError unless each number is finite, and within 100 m and one turn: of mountings in mm or deg most are
/// not.
void requireMounting(const char* name, const std::vector<double>& x_y_z_roll_pitch_yaw);

/// Of a list that requireMounting() takes.
Pose mountingPose(const std::vector<double>& x_y_z_roll_pitch_yaw);

}  // namespace fail_aware
