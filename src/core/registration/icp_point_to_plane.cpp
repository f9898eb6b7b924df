#include "core/registration/icp_point_to_plane.hpp"

#include <algorithm>
#include <optional>

#include "plane_pairs.hpp"

namespace fail_aware {

namespace {

/// The weakest horizontal direction; nullopt where every horizontal direction is well observed.
std::optional<WeakHorizontal> weakHorizontal(const NormalEquations& equations, const InformationSupport::Params& params,
                                             const Pose& T_odom_cog, double kernel_m, PlanePairs& pairs) {
  const std::optional<Eigen::Vector2d> weakest =
      weakDirection(equations.H.topLeftCorner<2, 2>(), equations.weight, params.below_ratio);
  if (!weakest) return std::nullopt;
  InformationSupport support(params);
  pairs.forEach(T_odom_cog, kernel_m, kAsCorrected, [&](const PlanePair& pair, std::size_t) {
    const double along = weakest->dot(pair.normal.head<2>());
    support.add(pair.position, pair.weight * along * along, pair.weight * pair.normal_variance);
  });
  return WeakHorizontal{*weakest, support.countedRatio()};
}

}  // namespace

Measurement IcpPointToPlane::align(const std::vector<Eigen::Vector3f>& points_cog, const VoxelMap& map,
                                   const Pose& T_odom_cog_predicted, double sigma_yaw_rad) const {
  Measurement result;
  result.T_odom_cog = T_odom_cog_predicted;
  if (map.empty()) return result;
  PlanePairs pairs(params_, points_cog, map, T_odom_cog_predicted, sigma_yaw_rad);
  Pose T = T_odom_cog_predicted;
  NormalEquations equations;
  bool converged = false;
  Vector6d step = Vector6d::Zero();
  double kernel_m = std::max(params_.initial_kernel_m, params_.kernel_m);
  std::optional<WeakHorizontal> weak;
  for (result.iterations = 1; result.iterations <= params_.max_iterations; ++result.iterations) {
    equations = pairs.linearize(T, kernel_m);
    if (static_cast<int>(equations.inliers) < params_.min_inliers) {
      result.status = MeasurementStatus::kTooFewPoints;
      return result;
    }
    if (result.iterations == 1) weak = weakHorizontal(equations, params_.support, T, kernel_m, pairs);
    if (weak) discount(equations, weak->direction, weak->counted_ratio);
    const Solution solution = solveObserved(equations, params_.observability);
    result.degenerate_directions = solution.degenerate_directions;
    result.min_information_ratio = solution.min_horizontal_ratio;
    if (solution.degenerate_directions == 6) {
      result.status = MeasurementStatus::kDegenerate;
      return result;
    }
    step = solution.dx;
    T = applyStep(T, step);
    if (kernel_m <= params_.kernel_m && stepWithin(step, params_, 1.0)) {
      converged = true;
      break;
    }
    kernel_m = std::max(0.5 * kernel_m, params_.kernel_m);
  }
  result.iterations = std::min(result.iterations, params_.max_iterations);
  result.T_odom_cog = T;
  result.inliers = equations.inliers;
  result.inlier_ratio = static_cast<double>(equations.inliers) / static_cast<double>(points_cog.size());
  result.rms_residual_m = rmsResidual(equations);
  const double inflation = kernelInflation(curvatureRatio(equations), params_.usual_curvature_ratio);
  result.covariance = covarianceObserved(equations, params_.correlation_inflation * inflation, params_.observability);
  judgeEnd(params_, converged, step, inflation, result);
  return result;
}

}  // namespace fail_aware
