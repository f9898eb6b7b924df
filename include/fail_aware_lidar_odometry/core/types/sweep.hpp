// Part of the public header.
#pragma once

#include "fail_aware_lidar_odometry/sweep.hpp"  // IWYU pragma: export
