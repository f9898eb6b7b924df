// Poses from elsewhere as a CSV file: base_link in odom, a row a pose.
//
// Columns: stamp (s, as the clouds'), x, y, z (m), qx, qy, qz, qw, sigma_x, sigma_y, sigma_z (m), sigma_roll, sigma_pitch,
// sigma_yaw (rad; all three 0: rotation not measured; all six 0: known exactly, for a pose that is set).
// Failure: InputError naming file, line and what is wrong.
#pragma once

#include <string>
#include <vector>

#include "fail_aware_lidar_odometry/sweep.hpp"

namespace fail_aware {

/// In the order of their stamps.
std::vector<ExternalPose> readExternalPoses(const std::string& path);

}  // namespace fail_aware
