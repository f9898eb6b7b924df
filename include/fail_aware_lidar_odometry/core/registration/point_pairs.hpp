// The point pairs of one sweep and one map, and their normal equations (paper, section "Multiplex General ICP").
//
// A pair is a point and the nearest point of the map within max_distance_m, weighted with a Geman-McClure kernel.
// Information (not in the article): the nearest of a plane's points slides along the plane, so that a pair informs only
// along the normal of its partner's plane, and horizontally where the partner stands on a post. Pairs whose surface is
// unknown are taken to inform on all directions as the other pairs do together.
//
// Points: m, frame of the centre of gravity. The pose: of the centre of gravity in odom.
// Cost: one nearest-point query a point, on the threads of the caller's TBB arena; the same bits for any number of them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "fail_aware_lidar_odometry/core/cloud/voxel_map.hpp"
#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"
#include "fail_aware_lidar_odometry/core/registration/information_support.hpp"
#include "fail_aware_lidar_odometry/core/registration/normal_equations.hpp"

namespace fail_aware {

class PointPairs {
 public:
  using Neighborhoods = std::vector<VoxelMap::Neighborhood>;  ///< of the points that are used: every stride-th

  struct Params {
    double max_distance_m = 0.5;
    bool surface_information = true;  ///< false: a pair informs alike in all directions
    InformationSupport::Params support;
  };

  struct WeakHorizontal {
    Eigen::Vector2d direction;
    double counted_ratio = 1.0;  ///< of the information on this direction
  };

  /// Keeps references to the points and to the map.
  PointPairs(const std::vector<Eigen::Vector3f>& points_cog, const VoxelMap& map, const Params& params)
      : points_cog_(points_cog), map_(map), params_(params) {}

  std::size_t size() const { return points_cog_.size(); }

  /// Of every stride-th point.
  NormalEquations linearize(std::size_t stride, const Pose& T_odom_cog, double kernel_m,
                            Neighborhoods& neighborhoods) const;

  /// The weakest horizontal direction; nothing where every horizontal direction is well observed.
  std::optional<WeakHorizontal> weakHorizontal(std::size_t stride, const Pose& T_odom_cog, double kernel_m,
                                               Neighborhoods& neighborhoods) const;

  /// Of all points: the mean squared distance, where a point without a partner counts as max_distance_m away.
  double meanSquaredError(const NormalEquations& equations, double points) const {
    const double cut2 = params_.max_distance_m * params_.max_distance_m;
    return (equations.squared_error + (points - equations.weight_unscaled) * cut2) / points;
  }

 private:
  const std::vector<Eigen::Vector3f>& points_cog_;
  const VoxelMap& map_;
  Params params_;
};

}  // namespace fail_aware
