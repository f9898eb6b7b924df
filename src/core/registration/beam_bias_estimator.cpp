#include "core/registration/beam_bias_estimator.hpp"

#include <cmath>

#include "plane_pairs.hpp"

namespace fail_aware {

namespace {

constexpr std::size_t kMaxBeams = 256;
constexpr double kMinDistance_m = 1.0;  // of the lidar, horizontally

IcpPointToPlane::Params allNormals(IcpPointToPlane::Params planes) {
  planes.filter_normals = false;
  planes.range_weight_m = 0.0;
  return planes;
}

using Evidence = std::vector<BeamEvidence>;

BeamEvidence& of(std::uint16_t ring, Evidence& evidence) {
  if (ring >= evidence.size()) evidence.resize(ring + std::size_t{1});
  return evidence[ring];
}

// What the map shares of heights on the ground: what is constant, linear or quadratic in the distance, as elevations.
Eigen::MatrixXd smoothInDistance(const Evidence& not_upright) {
  Eigen::MatrixXd patterns(static_cast<Eigen::Index>(not_upright.size()), 3);
  for (std::size_t ring = 0; ring < not_upright.size(); ++ring) {
    const double range_m = not_upright[ring].range_m / not_upright[ring].weight;
    patterns.row(static_cast<Eigen::Index>(ring)) << 1.0 / range_m, 1.0, range_m;
  }
  return patterns;
}

}  // namespace

BeamBiasEstimator::BeamBiasEstimator(const Params& params, const IcpPointToPlane::Params& planes)
    : params_(params), planes_(allNormals(planes)), ranges_m_(params.range_m), elevations_rad_(params.elevation_rad) {}

void BeamBiasEstimator::observe(const std::vector<Eigen::Vector3f>& points_cog, const std::vector<std::uint16_t>& rings,
                                const Pose& T_cog_lidar, const VoxelMap& map, const Pose& T_odom_cog) {
  if (!params_.enabled || map.empty() || rings.size() != points_cog.size()) return;
  Evidence walls, not_upright;
  const Pose T_lidar_cog = T_cog_lidar.inverse();
  const Eigen::Matrix3d R_lidar_odom = T_lidar_cog.linear() * T_odom_cog.linear().transpose();
  PlanePairs pairs(planes_, points_cog, map, T_odom_cog, 0.0);
  pairs.forEach(T_odom_cog, params_.kernel_m, kAsCorrected, [&](const PlanePair& pair, std::size_t i) {
    if (rings[i] >= kMaxBeams) return;
    const Eigen::Vector3d beam = T_lidar_cog * points_cog[i].cast<double>();
    const Eigen::Vector3d normal = R_lidar_odom * pair.normal;
    const double range_m = beam.norm(), distance_m = beam.head<2>().norm();
    if (std::abs(pair.normal.z()) <= params_.max_wall_normal_z) {
      const double obliqueness = normal.dot(beam) / range_m;
      if (std::abs(obliqueness) < params_.min_obliqueness) return;
      of(rings[i], walls).add(pair.kernel_weight, obliqueness, pair.residual_m, range_m);
    } else if (distance_m > kMinDistance_m) {
      const Eigen::Vector3d per_rad(-beam.z() * beam.x() / distance_m, -beam.z() * beam.y() / distance_m, distance_m);
      of(rings[i], not_upright).add(pair.kernel_weight, normal.dot(per_rad), pair.residual_m, range_m);
    }
  });
  ranges_m_.update(walls, Eigen::VectorXd::Ones(static_cast<Eigen::Index>(walls.size())));
  elevations_rad_.update(not_upright, smoothInDistance(not_upright));
}

}  // namespace fail_aware
