#include "fail_aware_lidar_odometry/core/registration/relocalization.hpp"

#include <algorithm>
#include <cmath>

#include "fail_aware_lidar_odometry/core/parameters/check.hpp"

namespace fail_aware {

namespace {

MultiplexIcp::Params widened(const Relocalization::Params& params, const MultiplexIcp::Params& usual) {
  params.validate();
  MultiplexIcp::Params wide = usual;
  wide.seeds = 8;
  wide.max_spread_m = std::max(params.max_spread_m, usual.max_spread_m);
  wide.max_distance_m = params.max_distance_m;
  wide.initial_kernel_m = params.max_distance_m;
  wide.kernel_m = params.narrow_m;
  wide.max_refined_seeds = wide.seeds;
  return wide;
}

MultiplexIcp::Params fromOneSeed(const Relocalization::Params& params, const MultiplexIcp::Params& usual) {
  MultiplexIcp::Params one = usual;
  one.seeds = 1;
  one.min_inlier_share = params.min_inlier_share;
  return one;
}

}  // namespace

void Relocalization::Params::validate() const {
  requirePositive("min_sigma_m", min_sigma_m);
  requirePositive("max_spread_m", max_spread_m);
  requirePositive("max_distance_m", max_distance_m);
  requireWithin("min_inlier_share", min_inlier_share, 0.0, 1.0);
  requirePositive("narrow_m", narrow_m);
}

Relocalization::Relocalization(const Params& params, const MultiplexIcp::Params& usual)
    : params_(params), wide_(widened(params, usual)), usual_(fromOneSeed(params, usual)) {}

bool Relocalization::isNeeded(const Matrix6d& covariance) const {
  return params_.enabled && covariance.diagonal().head<3>().maxCoeff() > params_.min_sigma_m * params_.min_sigma_m;
}

std::optional<Pose> Relocalization::find(const std::vector<Eigen::Vector3f>& points_cog, const VoxelMap& map,
                                         const Pose& T_odom_cog_predicted, const Matrix6d& covariance) const {
  const Measurement found = wide_.align(points_cog, map, T_odom_cog_predicted, covariance);
  if (!found.ok()) return std::nullopt;
  const Measurement confirmed = usual_.align(points_cog, map, found.T_odom_cog, covariance);
  if (!confirmed.ok()) return std::nullopt;
  return confirmed.T_odom_cog;
}

}  // namespace fail_aware
