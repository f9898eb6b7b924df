// External poses as a CSV file: base_link in odom, one row per pose.
//
// Columns: stamp (s, in the clouds' clock), x, y, z (m), qx, qy, qz, qw, sigma_x, sigma_y, sigma_z (m), sigma_roll,
// sigma_pitch, sigma_yaw (rad; all three 0: rotation not measured; all six 0: exact, for a pose that is set).
// Failure: InputError naming file, line and what is wrong.
#pragma once

#include <string>
#include <vector>

#include "fail_aware_lidar_odometry/sweep.hpp"

namespace fail_aware {

/// Sorted by stamp.
std::vector<ExternalPose> readExternalPoses(const std::string& path);

}  // namespace fail_aware
