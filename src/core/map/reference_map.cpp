#include "core/map/reference_map.hpp"

namespace fail_aware {

namespace {

// Of 100 m around, with false returns in the air, too: a map that is copied makes the sweep that it meets wait for 0.1 s.
constexpr std::size_t kReservedVoxels = std::size_t{1} << 18;

}  // namespace

ReferenceMap::ReferenceMap(const Params& params) : params_(params), map_(params.voxels) {
  map_.reserve(kReservedVoxels);
}

void ReferenceMap::add(const std::vector<Eigen::Vector3f>& points_cog, const Pose& T_odom_cog) {
  const bool local_map = params_.sweeps == 0;
  if (!local_map) map_.clear();
  map_.insert(points_cog, T_odom_cog);
  // what lies beyond the range is trimmed every few metres, so that the trimming costs little a sweep
  constexpr double kTrimEvery_m = 5.0;
  if (local_map && (T_odom_cog.translation() - trimmed_at_odom_).norm() > kTrimEvery_m) {
    trimmed_at_odom_ = T_odom_cog.translation();
    map_.removeFartherThan(params_.range_m + kTrimEvery_m, trimmed_at_odom_);
  }
}

void ReferenceMap::clear() {
  map_.clear();
  trimmed_at_odom_.setZero();
}

}  // namespace fail_aware
