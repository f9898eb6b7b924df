// Part of the public header.
#pragma once

#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"
#include "fail_aware_lidar_odometry/monitor.hpp"  // IWYU pragma: export
