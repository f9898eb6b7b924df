// The point pairs of one sweep and one map, and their normal equations (paper, section "Multiplex General ICP").
//
// A pair is a point and the nearest map point within max_distance_m, weighted with a Geman-McClure kernel.
// Information (not in the paper): the nearest point of a plane slides along the plane. A pair therefore informs only
// along the normal of its partner's plane, and horizontally if the partner is on a post. Pairs with unknown surface
// inform on the directions as the other pairs do together. The near side of a post moves as the vehicle passes
// (near_side.hpp).
//
// Points: m, frame of the centre of gravity. Pose: of the centre of gravity in odom.
// Cost: one nearest-point query per point, on the threads of the caller's TBB arena; the result is bit-identical for
// any number of threads.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/map/voxel_map.hpp"
#include "core/registration/information_support.hpp"
#include "core/registration/normal_equations.hpp"

namespace fail_aware {

class PointPairs {
 public:
  using Neighborhoods = std::vector<VoxelMap::Neighborhood>;  ///< of the points used: every stride-th

  struct Params {
    double max_distance_m = 0.5;
    bool surface_information = true;  ///< false: a pair informs equally in all directions
    InformationSupport::Params support;
  };

  /// Keeps references to the points and to the map.
  PointPairs(const std::vector<Eigen::Vector3f>& points_cog, const VoxelMap& map, const Params& params)
      : points_cog_(points_cog), map_(map), params_(params) {}

  std::size_t size() const { return points_cog_.size(); }

  /// Uses every stride-th point.
  NormalEquations linearize(std::size_t stride, const Pose& T_odom_cog, double kernel_m,
                            Neighborhoods& neighborhoods) const;

  /// The weakest horizontal direction; nullopt where every horizontal direction is well observed.
  std::optional<WeakHorizontal> weakHorizontal(std::size_t stride, const Pose& T_odom_cog, double kernel_m,
                                               Neighborhoods& neighborhoods) const;

  /// The mean squared distance over all points; a point without a partner counts as max_distance_m.
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
