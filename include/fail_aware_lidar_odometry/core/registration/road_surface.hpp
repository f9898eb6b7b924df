// The road in a sweep, as samples of its height: what road_profile_odometry.hpp lays over each other. Not in the article.
//
// A quadric is fitted through the most common height below the lidar, robustly; a sample is the mean height above it of
// the points in one direction from the sensor as it was when it fired.
// Frames: axes of the vehicle, origin at the lidar. Failure: nothing, if there is too little road. Cost: 2 ms.
#pragma once

#include <optional>
#include <vector>

#include "fail_aware_lidar_odometry/core/cloud/voxel_key.hpp"
#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"
#include "fail_aware_lidar_odometry/core/types/corrected_sweep.hpp"

namespace fail_aware {

struct RoadSurfaceParams {
  double min_range_m = 3.0;  ///< of the points used, horizontal, from the lidar
  double max_range_m = 16.0;
  double half_width_m = 4.0;             ///< of the strip of road used
  double direction_elevation_deg = 0.1;  ///< size of a direction
  double direction_azimuth_deg = 0.5;
  double max_height_m = 0.03;  ///< what stands out five times more is no road
};

struct RoadSample {
  VoxelKey direction = 0;
  float x = 0.0f, y = 0.0f, time_s = 0.0f, height = 0.0f;  ///< m, s relative to the stamp
  float weight = 0.0f;                                     ///< 1/m^2
};

/// `twist_cog`: the motion (m/s, rad/s) that the sweep was corrected for.
std::optional<std::vector<RoadSample>> sampleRoad(const CorrectedSweep& sweep, const Pose& T_cog_lidar,
                                                  const Vector6d& twist_cog, const RoadSurfaceParams& params);

}  // namespace fail_aware
