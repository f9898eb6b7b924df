#include "core/map/above_ground_reference.hpp"

#include <cmath>

#include "core/stamp_difference.hpp"

namespace fail_aware {

namespace {

constexpr std::size_t kKept = 20000;  // points, about

VoxelMap::Params denseReference() {
  VoxelMap::Params map;
  map.max_points = VoxelMap::kMaxPoints;
  map.min_point_spacing_m = 0.1;
  return map;
}

}  // namespace

AboveGroundReference::AboveGroundReference(const Params& params) : params_(params), map_(denseReference()) {}

void AboveGroundReference::keep(const std::vector<Eigen::Vector3f>& points_cog, const Pose& T_odom_cog,
                                double stamp_s) {
  if (!params_.enabled) return;
  map_.clear();
  T_odom_cog_ = T_odom_cog;
  stamp_s_ = stamp_s;
  const AboveGroundPoints above_ground =
      findAboveGroundPoints(pointsWithin(points_cog, params_.max_range_m), params_.points, kKept);
  if (above_ground.ratio > params_.max_above_ground_ratio) return;
  std::vector<Eigen::Vector3f> points;
  points.reserve(above_ground.points.size());
  for (const AboveGroundPoint& point : above_ground.points) points.push_back(point.position.cast<float>());
  map_.insert(points, T_odom_cog);
}

bool AboveGroundReference::isDue(const Pose& T_odom_cog, double stamp_s) const {
  return !stamp_s_ || (T_odom_cog.translation() - T_odom_cog_.translation()).norm() > params_.max_distance_m ||
         std::abs(secondsBetween(*stamp_s_, stamp_s)) > params_.max_age_s;
}

void AboveGroundReference::clear() {
  map_.clear();
  stamp_s_.reset();
}

}  // namespace fail_aware
