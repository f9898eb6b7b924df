// The road in a sweep, as samples of its height, for road_profile_odometry.hpp. Not in the paper.
//
// A quadric is fitted robustly through the most common height below the lidar. A sample is the mean height above the
// quadric of the points in one direction from the sensor, at the sensor's position when it fired.
// Frames: axes of the vehicle, origin at the lidar.
// Failure: nullopt, if there is too little road. Cost: 2 ms.
#pragma once

#include <optional>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/preprocessing/voxel_key.hpp"
#include "core/types/corrected_sweep.hpp"

namespace fail_aware {

constexpr double kRoadRange_m = 16.0;     ///< farthest points used, horizontal: farther beams are too grazing
constexpr double kRoadHalfWidth_m = 4.0;  ///< of the strip of road used: own lane and its neighbours
/// Higher points (from the quadric five times as high ones) are not road: the profile is millimetres, range noise
/// centimetres.
constexpr double kRoadHeight_m = 0.03;

struct RoadSample {
  VoxelKey direction = 0;
  float x = 0.0f, y = 0.0f, time_s = 0.0f, height = 0.0f;  ///< m, s relative to the stamp
  float weight = 0.0f;                                     ///< 1/m^2
};

/// `twist_cog`: the motion (m/s, rad/s) that the sweep was deskewed for.
std::optional<std::vector<RoadSample>> sampleRoad(const CorrectedSweep& sweep, const Pose& T_cog_lidar,
                                                  const Vector6d& twist_cog);

}  // namespace fail_aware
