#include "core/registration/corner_svd/corner_reference.hpp"

#include <algorithm>
#include <cstddef>

namespace fail_aware {

namespace {

// The mean of all sightings, `seen` being the newest; both corners at one height, planes in one order.
Corner blended(const Corner& corner, const Corner& seen) {
  const int sightings = corner.sightings + 1;
  const double ratio = 1.0 / sightings;
  const auto mix = [&](const auto& a, const auto& b) { return ((1.0 - ratio) * a + ratio * b).eval(); };
  Corner mean = corner;
  mean.sightings = sightings;
  mean.sweeps_unseen = 0;
  mean.M = mix(corner.M, seen.M);
  mean.J = mean.M + Corner::kLineLength * mix(corner.lineDirection(), seen.lineDirection()).normalized();
  mean.N = mean.M + Corner::kPlaneLength * mix((corner.N - corner.M).eval(), (seen.N - seen.M).eval()).normalized();
  for (std::size_t k = 0; k < 2; ++k) {
    mean.planes[k].normal = mix(corner.planes[k].normal, seen.planes[k].normal).normalized();
    mean.planes[k].rms_m = (1.0 - ratio) * corner.planes[k].rms_m + ratio * seen.planes[k].rms_m;
    mean.planes[k].points = seen.planes[k].points;
    mean.planes[k].rectangle = seen.planes[k].rectangle;
  }
  return mean;
}

}  // namespace

void CornerReference::update(const std::vector<Corner>& corners_cog, const Pose& T_odom_cog) {
  if (!isFinite(T_odom_cog)) return;
  if (params_.sweeps == 1) clear();
  for (Corner& corner : corners_odom_) ++corner.sweeps_unseen;
  const std::vector<Corner> seen = movedCorners(T_odom_cog, corners_cog);
  std::vector<bool> known(seen.size(), false);
  for (const CornerPair& match :
       matchCorners(seen, corners_odom_, params_.merge_distance_m, params_.max_normal_difference_deg)) {
    Corner& corner = corners_odom_[match.second];
    corner = blended(corner, match.corner);
    known[match.first] = true;
  }
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (!known[i]) corners_odom_.push_back(seen[i]);
  }
  const auto is_gone = [&](const Corner& corner) {
    const bool near = (corner.M - T_odom_cog.translation()).norm() <= params_.max_range_m;
    return !near || corner.sweeps_unseen >= params_.sweeps;
  };
  corners_odom_.erase(std::remove_if(corners_odom_.begin(), corners_odom_.end(), is_gone), corners_odom_.end());
}

}  // namespace fail_aware
