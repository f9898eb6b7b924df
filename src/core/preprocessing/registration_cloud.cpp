#include "core/preprocessing/registration_cloud.hpp"

#include <algorithm>
#include <limits>

#include "core/preprocessing/correction.hpp"
#include "core/stamp_difference.hpp"

namespace fail_aware {

namespace {

constexpr float kMinCorrected_m = 1.0f;  // nearer points are moved by a large part of their range

void gather(const std::vector<Eigen::Vector3f>& points, const std::vector<float>& times,
            const std::vector<std::uint32_t>& indices, std::vector<Eigen::Vector3f>& out_points,
            std::vector<float>& out_times) {
  out_points.clear();
  out_times.clear();
  for (const std::uint32_t i : indices) out_points.push_back(points[i]);
  if (times.empty()) return;
  for (const std::uint32_t i : indices) out_times.push_back(times[i]);
}

void correctBeams(const std::vector<std::uint16_t>& rings, const std::vector<std::uint32_t>& indices,
                  const BeamBias& bias, std::vector<Eigen::Vector3f>& points_lidar) {
  if (bias.too_far_m.empty() && bias.too_high_rad.empty()) return;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const std::uint16_t ring = rings[indices[i]];
    Eigen::Vector3f& p = points_lidar[i];
    const float range_m = p.norm(), distance_m = p.head<2>().norm();
    if (ring < bias.too_far_m.size() && range_m > kMinCorrected_m) p *= 1.0f - bias.too_far_m[ring] / range_m;
    if (ring < bias.too_high_rad.size() && distance_m > kMinCorrected_m) {
      const float angle = bias.too_high_rad[ring], shift = 1.0f + angle * p.z() / distance_m;
      p = Eigen::Vector3f(p.x() * shift, p.y() * shift, p.z() - angle * distance_m);
    }
  }
}

}  // namespace

void RegistrationCloud::redeskewBy(const Vector6d& delta_twist_cog, double still_s) {
  if (map_times_s.empty()) return;
  std::vector<float> since_still_s;
  const auto move = [&](std::vector<Eigen::Vector3f>& points_cog, const std::vector<float>& times_s) {
    since_still_s = times_s;
    for (float& time_s : since_still_s) time_s -= static_cast<float>(still_s);
    fail_aware::redeskewBy(points_cog, since_still_s, delta_twist_cog);
  };
  move(map_points_cog, map_times_s);
  move(plane_points_cog, plane_times_s);
  move(point_points_cog, point_times_s);
}

void RegistrationCloudBuilder::Params::checkRules() const {
  requireParameter(max_range_m > min_range_m && max_range_m <= 1000.0, "max_range_m", max_range_m,
                   "> min_range_m and <= 1000");
  requireParameter(plane_voxel_m >= map_voxel_m, "plane_voxel_m", plane_voxel_m, ">= map_voxel_m", map_voxel_m);
  requireWithin("plane_voxel_m", plane_voxel_m, map_voxel_m, 100.0);
  requireParameter(point_voxel_m >= map_voxel_m, "point_voxel_m", point_voxel_m, ">= map_voxel_m", map_voxel_m);
  requireWithin("point_voxel_m", point_voxel_m, map_voxel_m, 100.0);
}

RegistrationCloudBuilder::RegistrationCloudBuilder(const Params& params,
                                                   const std::optional<SweepTimingParams>& compensated_head)
    : params_(params), compensated_head_(compensated_head) {}

void RegistrationCloudBuilder::build(const CorrectedSweep& sweep, const Pose& T_cog_lidar, RegistrationCloud& cloud,
                                     const BeamBias& bias) {
  cloud.stamp_s = sweep.stamp_s;
  of_sweep_ = filter_.select(sweep.points_lidar, params_.map_voxel_m, params_.min_range_m, params_.max_range_m);
  gather(sweep.points_lidar, sweep.times_s, of_sweep_, cloud.map_points_cog, cloud.map_times_s);
  cloud.compensated = compensated_head_ && sweep.times_s.empty();
  if (cloud.compensated) {
    timesByAzimuth(*compensated_head_, cloud.map_points_cog, 0.5, kUsualPeriod_s, cloud.map_times_s);
  }
  cloud.middle_s = middleOf(cloud.map_times_s);
  const bool has_rings = sweep.rings.size() == sweep.points_lidar.size();
  if (has_rings) correctBeams(sweep.rings, of_sweep_, bias, cloud.map_points_cog);
  const Eigen::Matrix3f R = T_cog_lidar.linear().cast<float>();
  const Eigen::Vector3f t = T_cog_lidar.translation().cast<float>();
  for (Eigen::Vector3f& p : cloud.map_points_cog) p = (R * p + t).eval();
  const auto thinned = [&](double voxel_m) -> const std::vector<std::uint32_t>& {
    constexpr double kAnyRange_m = std::numeric_limits<double>::infinity();
    chosen_ = filter_.select(cloud.map_points_cog, voxel_m, 0.0, kAnyRange_m, VoxelFilter::Order::kAsGiven);
    // in the sweep's order: consecutive points then access nearby parts of the map
    std::sort(chosen_.begin(), chosen_.end(), [&](auto a, auto b) { return of_sweep_[a] < of_sweep_[b]; });
    return chosen_;
  };
  gather(cloud.map_points_cog, cloud.map_times_s, thinned(params_.plane_voxel_m), cloud.plane_points_cog,
         cloud.plane_times_s);
  cloud.plane_rings.clear();
  if (has_rings) {
    for (const std::uint32_t i : chosen_) cloud.plane_rings.push_back(sweep.rings[of_sweep_[i]]);
  }
  gather(cloud.map_points_cog, cloud.map_times_s, thinned(params_.point_voxel_m), cloud.point_points_cog,
         cloud.point_times_s);
}

}  // namespace fail_aware
