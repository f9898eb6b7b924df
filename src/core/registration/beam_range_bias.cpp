#include "core/registration/beam_range_bias.hpp"

#include <algorithm>
#include <cmath>

#include "core/parameters/check.hpp"
#include "plane_pairs.hpp"

namespace fail_aware {

namespace {

constexpr std::size_t kMaxBeams = 256;
constexpr double kMaxOffset_m = 0.2;  // a head that is off by more is broken

IcpPointToPlane::Params allNormals(IcpPointToPlane::Params planes) {
  planes.filter_normals = false;
  planes.range_weight_m = 0.0;
  return planes;
}

struct Sums {
  double distance = 0.0, obliqueness = 0.0;
};

}  // namespace

void BeamRangeBias::Params::validate() const {
  requirePositive("sigma_m", sigma_m);
  requireNotNegative("walk_m", walk_m);
  requirePositive("residual_m", residual_m);
  requirePositive("kernel_m", kernel_m);
  requireWithin("forget", forget, 0.0, 1.0);
  requireWithin("min_obliqueness", min_obliqueness, 0.0, 1.0);
  requireWithin("max_normal_z", max_normal_z, 0.0, 1.0);
}

BeamRangeBias::BeamRangeBias(const Params& params, const IcpPointToPlane::Params& planes)
    : params_(params), planes_(allNormals(planes)) {
  params_.validate();
  planes_.validate();
}

void BeamRangeBias::observe(const std::vector<Eigen::Vector3f>& points_cog, const std::vector<std::uint16_t>& rings,
                            const Eigen::Vector3d& lidar_in_cog, const VoxelMap& map, const Pose& T_odom_cog) {
  if (!params_.enabled || map.empty() || rings.size() != points_cog.size()) return;
  std::vector<Sums> sums;
  const Eigen::Matrix3d R = T_odom_cog.linear();
  PlanePairs pairs(planes_, points_cog, map, T_odom_cog, 0.0);
  pairs.forEach(T_odom_cog, params_.kernel_m, kAsCorrected, [&](const PlanePair& pair, std::size_t i) {
    if (std::abs(pair.normal.z()) > params_.max_normal_z || rings[i] >= kMaxBeams) return;
    const double g = pair.normal.dot(R * (points_cog[i].cast<double>() - lidar_in_cog).normalized());
    if (std::abs(g) < params_.min_obliqueness) return;
    if (rings[i] >= sums.size()) sums.resize(rings[i] + std::size_t{1});
    sums[rings[i]].distance += pair.kernel_weight * g * pair.residual_m;
    sums[rings[i]].obliqueness += pair.kernel_weight * g * g;
  });
  if (sums.size() > offsets_m_.size()) {
    offsets_m_.resize(sums.size(), 0.0f);
    variances_m2_.resize(sums.size(), params_.sigma_m * params_.sigma_m);
  }
  double all_distance = 0.0, all_obliqueness = 0.0;
  for (const Sums& s : sums) all_distance += s.distance, all_obliqueness += s.obliqueness;
  if (!(all_obliqueness > 0.0)) return;
  const double common = all_distance / all_obliqueness;
  for (std::size_t ring = 0; ring < sums.size(); ++ring) {
    const Sums& s = sums[ring];
    variances_m2_[ring] =
        std::min(variances_m2_[ring] + params_.walk_m * params_.walk_m, params_.sigma_m * params_.sigma_m);
    if (!(s.obliqueness > 0.0)) continue;
    const double noise = params_.residual_m * params_.residual_m / s.obliqueness;
    const double known = static_cast<double>(offsets_m_[ring]);
    const double gain = variances_m2_[ring] / (variances_m2_[ring] + noise);
    const double offset_m = known + gain * (s.distance / s.obliqueness - common - params_.forget * known);
    offsets_m_[ring] = static_cast<float>(std::clamp(offset_m, -kMaxOffset_m, kMaxOffset_m));
    variances_m2_[ring] *= 1.0 - gain;
  }
}

void BeamRangeBias::reset() {
  offsets_m_.clear();
  variances_m2_.clear();
}

}  // namespace fail_aware
