// A sweep's points that stand above the ground: what is upright shows a horizontal motion at any distance, and ground
// does not (its scan lines travel with the sensor). Not in the article.
//
// A point stands if it is `min_height_m` above the lowest of its column. Each carries its place, a cell of the
// horizontal plane: a sum over places, not points, is not dominated by a single near object.
// Frames: all points in the frame of the input, z up. Cost: two hash probes a point.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/map/voxel_map.hpp"

namespace fail_aware {

struct AboveGroundPoint {
  Eigen::Vector3d position;  ///< m
  std::size_t place;         ///< 0 ... places - 1
};

struct AboveGroundPoints {
  std::vector<AboveGroundPoint> points;
  std::size_t places = 0;
  std::vector<double> counts;  ///< of the points, each place
  double ratio = 0.0;          ///< of the input that is above the ground, whether listed or not
};

struct AboveGroundPointsParams {
  double cell_m = 3.0;    ///< side of a place
  double column_m = 0.5;  ///< side of the columns in which height is measured
  double min_height_m = 0.4;
};

/// At most about `enough` of them, every n-th.
AboveGroundPoints findAboveGroundPoints(const std::vector<Eigen::Vector3f>& points,
                                        const AboveGroundPointsParams& params, std::size_t enough);

/// Those no farther than range_m.
std::vector<Eigen::Vector3f> pointsWithin(const std::vector<Eigen::Vector3f>& points, double range_m);

/// Each place's mean weight, 0 ... 1: how near its points, moved by T, are to those of `map` (Geman-McClure kernel,
/// none beyond kFarthestInKernels of it). `unmet`: the weight of a moved point that is near none; 0 without it.
std::vector<double> votesOfPlaces(const AboveGroundPoints& above_ground, const VoxelMap& map, const Pose& T,
                                  double kernel_m, const std::function<double(const Eigen::Vector3d&)>& unmet = {});

constexpr double kFarthestInKernels = 3.0;

}  // namespace fail_aware
