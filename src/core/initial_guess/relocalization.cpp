#include "core/initial_guess/relocalization.hpp"

#include <algorithm>

namespace fail_aware {

namespace {

constexpr int kNarrowingSteps = 3;    // factor on the usual ICP's iterations
constexpr double kShortGap_s = 0.75;  // up to this gap the seeds around the prediction reach far enough
constexpr double kTurn_rad_s2 = 0.2;  // standard deviations of a vehicle's yaw and forward acceleration
constexpr double kAcceleration_mps2 = 0.5;

IcpPointToPoint::Params widened(const Relocalization::Params& params, const IcpPointToPoint::Params& usual) {
  IcpPointToPoint::Params wide = usual;
  wide.seeds = 8;
  wide.max_spread_m = std::max(params.max_spread_m, usual.max_spread_m);
  wide.max_distance_m = params.max_distance_m;
  wide.initial_kernel_m = params.max_distance_m;
  wide.kernel_m = params.narrow_m;
  wide.max_refined_seeds = wide.seeds;
  return wide;
}

// Starts from the pose of the search. z, roll and pitch still come from the prediction, so more iterations are needed.
IcpPointToPoint::Params narrowing(const Relocalization::Params& params, const IcpPointToPoint::Params& usual) {
  IcpPointToPoint::Params one = widened(params, usual);
  one.seeds = 1;
  one.max_iterations = std::min(kNarrowingSteps * usual.max_iterations, IcpPointToPoint::kMostIterations);
  return one;
}

IcpPointToPoint::Params fromOneSeed(const IcpPointToPoint::Params& usual, double min_inlier_ratio) {
  IcpPointToPoint::Params one = usual;
  one.seeds = 1;
  one.min_inlier_ratio = min_inlier_ratio;
  return one;
}

// Covariance of the driver's possible actions since the last inserted sweep. For a single long interval the prediction
// already contains it; the search range then grows by half.
Matrix6d steered(const Relocalization::Gap& gap, const Eigen::Matrix3d& R_odom_cog) {
  const double yaw_rad = 0.5 * kTurn_rad_s2 * gap.duration_s * gap.duration_s;
  const double along_m = 0.5 * kAcceleration_mps2 * gap.duration_s * gap.duration_s;
  // the turn starts with the gap and grows with the square of its duration
  const double across_m = gap.distance_m * yaw_rad / 3.0;
  const Eigen::Vector2d ahead = R_odom_cog.col(0).head<2>().normalized(), across(-ahead.y(), ahead.x());
  Matrix6d covariance = Matrix6d::Zero();
  covariance.topLeftCorner<2, 2>() =
      along_m * along_m * ahead * ahead.transpose() + across_m * across_m * across * across.transpose();
  covariance(5, 5) = yaw_rad * yaw_rad;
  return covariance;
}

std::optional<Pose> confirmedBy(const IcpPointToPoint& icp, const RegistrationCloud& cloud, const VoxelMap& map,
                                const Measurement& found, const Matrix6d& covariance) {
  const Measurement confirmed = icp.align(cloud.point_points_cog, map, found.T_odom_cog, covariance);
  return confirmed.ok() ? std::optional<Pose>(confirmed.T_odom_cog) : std::nullopt;
}

}  // namespace

Relocalization::Relocalization(const Params& params, const IcpPointToPoint::Params& usual)
    : params_(params),
      wide_(widened(params, usual)),
      narrowing_(narrowing(params, usual)),
      usual_(fromOneSeed(usual, usual.min_inlier_ratio)),
      strict_(fromOneSeed(usual, params.min_inlier_ratio)) {}

bool Relocalization::isNeeded(const Matrix6d& covariance) const {
  return params_.enabled && covariance.diagonal().head<2>().maxCoeff() > params_.min_sigma_m * params_.min_sigma_m;
}

std::optional<Pose> Relocalization::find(const RegistrationCloud& cloud, const VoxelMap& map,
                                         const Pose& T_odom_cog_predicted, const Matrix6d& covariance,
                                         const Gap& gap) const {
  std::optional<Pose> place;
  if (params_.search.enabled && findByCorrelation(params_.search, cloud.map_points_cog, map, T_odom_cog_predicted,
                                                  covariance + steered(gap, T_odom_cog_predicted.linear()), place)) {
    if (place) {
      const Measurement narrowed = narrowing_.align(cloud.point_points_cog, map, *place, covariance);
      return narrowed.ok() ? confirmedBy(usual_, cloud, map, narrowed, covariance) : std::nullopt;
    }
    if (gap.duration_s > kShortGap_s) return std::nullopt;
  }
  const Measurement found = wide_.align(cloud.point_points_cog, map, T_odom_cog_predicted, covariance);
  return found.ok() ? confirmedBy(strict_, cloud, map, found, covariance) : std::nullopt;
}

}  // namespace fail_aware
