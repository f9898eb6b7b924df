#include "core/registration/icp_point_to_point.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"
#include "core/parallel.hpp"
#include "core/robust_kernel.hpp"

namespace fail_aware {

namespace {

void recordEnds(const std::vector<IcpPointToPoint::Descent>& descents, std::vector<SeedTrack>* tracks) {
  if (tracks == nullptr) return;
  for (const IcpPointToPoint::Descent& descent : descents) {
    for (const std::size_t seed : descent.seeds) (*tracks)[seed].T_odom_cog_end = descent.T;
  }
}

bool sameBasin(const Pose& a, const Pose& b, const IcpPointToPoint::Params& params) {
  return (a.translation() - b.translation()).norm() < params.merge_translation_m &&
         logSo3(a.linear().transpose() * b.linear()).norm() < params.merge_rotation_deg * kDegree;
}

/// Merges descents that have converged to the same pose.
void mergeBasins(const IcpPointToPoint::Params& params, std::vector<IcpPointToPoint::Descent>& descents) {
  for (std::size_t i = 1; i < descents.size();) {
    const auto end = descents.begin() + static_cast<std::ptrdiff_t>(i);
    const auto met = std::find_if(descents.begin(), end, [&](const IcpPointToPoint::Descent& other) {
      return sameBasin(other.T, descents[i].T, params);
    });
    if (met != end) {
      met->seeds.insert(met->seeds.end(), descents[i].seeds.begin(), descents[i].seeds.end());
      descents.erase(end);
    } else {
      ++i;
    }
  }
}

}  // namespace

std::vector<Pose> IcpPointToPoint::seeds(const Pose& T_odom_cog_predicted, const Matrix6d& predicted_covariance) const {
  if (params_.seeds == 1) return {T_odom_cog_predicted};
  const Eigen::Matrix3d body_covariance = T_odom_cog_predicted.linear().transpose() *
                                          predicted_covariance.topLeftCorner<3, 3>() * T_odom_cog_predicted.linear();
  const auto spreadOf = [&](double variance, double low, double high) {
    return std::clamp(params_.spread * std::sqrt(std::max(variance, 0.0)), low, high);
  };
  std::vector<Pose> seeds;
  for (const int axis : {0, 1, 3, 2}) {  // x, y, yaw, z: with fewer than eight seeds the likelier errors come first
    for (const double sign : {1.0, -1.0}) {
      if (static_cast<int>(seeds.size()) == params_.seeds) return seeds;
      Vector6d offset = Vector6d::Zero();
      if (axis < 3) {
        offset[axis] = sign * spreadOf(body_covariance(axis, axis), params_.min_spread_m, params_.max_spread_m);
      } else {
        offset[5] = sign * spreadOf(predicted_covariance(5, 5), params_.min_spread_deg * kDegree,
                                    params_.max_spread_deg * kDegree);
      }
      seeds.push_back(T_odom_cog_predicted * poseFromVector(offset));
    }
  }
  return seeds;
}

Solution IcpPointToPoint::solve(NormalEquations& equations, const Weak& weak) const {
  if (weak) discount(equations, weak->direction, weak->counted_ratio);
  return solveObserved(equations, params_.observability);
}

void IcpPointToPoint::descendTogether(const PointPairs& pairs, const Weak& weak, std::size_t stride,
                                      std::vector<Descent>& descents) const {
  double kernel_m = std::max(params_.initial_kernel_m, params_.kernel_m);
  for (int iteration = 0; iteration < params_.max_joint_iterations; ++iteration) {
    inParallelFor(descents.size(), [&](std::size_t i) {
      Descent& descent = descents[i];
      if (descent.settled) return;
      NormalEquations equations = pairs.linearize(stride, descent.T, kernel_m, descent.neighborhoods);
      const Solution step = solve(equations, weak);
      descent.T = applyStep(descent.T, step.dx);
      descent.settled = kernel_m <= params_.kernel_m && stepWithin(step.dx, params_, 5.0);  // refinement follows
    });
    const bool all_settled =
        std::all_of(descents.begin(), descents.end(), [](const Descent& descent) { return descent.settled; });
    mergeBasins(params_, descents);
    if (all_settled || descents.size() == 1) return;
    kernel_m = std::max(0.5 * kernel_m, params_.kernel_m);
  }
}

void IcpPointToPoint::keepBest(const PointPairs& pairs, std::size_t stride, std::vector<Descent>& descents) const {
  const auto most = static_cast<std::size_t>(params_.max_refined_seeds);
  if (descents.size() <= most) return;
  std::vector<std::pair<double, std::size_t>> scores;
  for (std::size_t i = 0; i < descents.size(); ++i) {
    Descent& descent = descents[i];
    const NormalEquations equations = pairs.linearize(stride, descent.T, params_.kernel_m, descent.neighborhoods);
    const auto used = static_cast<double>(descent.neighborhoods.size());
    scores.emplace_back(pairs.meanSquaredError(equations, used), i);
  }
  std::sort(scores.begin(), scores.end());
  std::vector<Descent> best;
  best.reserve(most);
  for (std::size_t i = 0; i < most; ++i) best.push_back(descents[scores[i].second]);
  descents.swap(best);
}

IcpPointToPoint::Refined IcpPointToPoint::refine(const PointPairs& pairs, const Weak& weak,
                                                 PointPairs::Neighborhoods& neighborhoods, Descent& descent) const {
  Refined refined;
  for (; refined.iterations < params_.max_iterations && !refined.converged; ++refined.iterations) {
    refined.equations = pairs.linearize(1, descent.T, params_.kernel_m, neighborhoods);
    if (static_cast<int>(refined.equations.inliers) < params_.min_inliers) break;
    refined.step = solve(refined.equations, weak);
    if (refined.step.degenerate_directions == 6) break;
    descent.T = applyStep(descent.T, refined.step.dx);
    refined.converged = stepWithin(refined.step.dx, params_, 1.0);
  }
  const auto all = static_cast<double>(pairs.size());
  refined.T_odom_cog = descent.T;
  refined.inlier_ratio = static_cast<double>(refined.equations.inliers) / std::max(all, 1.0);
  refined.usable = static_cast<int>(refined.equations.inliers) >= params_.min_inliers &&
                   refined.inlier_ratio >= params_.min_inlier_ratio;
  refined.error = pairs.meanSquaredError(refined.equations, all);
  return refined;
}

Measurement IcpPointToPoint::measurement(const Refined& best, double spread2_m2) const {
  Measurement result;
  result.T_odom_cog = best.T_odom_cog;
  result.inliers = best.equations.inliers;
  result.inlier_ratio = best.inlier_ratio;
  result.degenerate_directions = best.step.degenerate_directions;
  result.min_information_ratio = best.step.min_horizontal_ratio;
  result.rms_residual_m = rmsResidual(best.equations);
  result.seed_spread_m = std::sqrt(spread2_m2);
  const double inflation = kernelInflation(curvatureRatio(best.equations), params_.usual_curvature_ratio);
  const double variance =
      params_.correlation_inflation * inflation * result.rms_residual_m * result.rms_residual_m / 3.0;
  result.covariance = covarianceObserved(best.equations, variance, params_.observability);
  result.covariance.topLeftCorner<3, 3>().diagonal().array() += spread2_m2 / 3.0;
  for (const Eigen::Index tilt : {3, 4}) {
    result.covariance.row(tilt) *= params_.tilt_sigma_factor;
    result.covariance.col(tilt) *= params_.tilt_sigma_factor;
  }
  judgeEnd(params_, best.converged, best.step.dx, inflation, result);
  return result;
}

Measurement IcpPointToPoint::align(const std::vector<Eigen::Vector3f>& points_cog, const VoxelMap& map,
                                   const Pose& T_odom_cog_predicted, const Matrix6d& predicted_covariance,
                                   std::vector<SeedTrack>* tracks) const {
  Measurement result;
  result.T_odom_cog = T_odom_cog_predicted;
  if (tracks != nullptr) tracks->clear();
  if (map.empty()) return result;

  const PointPairs pairs(points_cog, map, {params_.max_distance_m, params_.surface_information, params_.support});
  const std::size_t stride =
      std::max<std::size_t>(1, points_cog.size() / static_cast<std::size_t>(params_.thinned_points));
  PointPairs::Neighborhoods around_prediction;  // of the thinned points of the joint descent
  const Weak weak = pairs.weakHorizontal(stride, T_odom_cog_predicted, params_.initial_kernel_m, around_prediction);
  std::vector<Descent> descents;
  for (const Pose& seed : seeds(T_odom_cog_predicted, predicted_covariance)) {
    descents.push_back({seed, {descents.size()}, false, around_prediction});
    if (tracks != nullptr) tracks->push_back({seed, seed, false});
  }
  if (descents.size() > 1) {
    descendTogether(pairs, weak, stride, descents);
    recordEnds(descents, tracks);
    keepBest(pairs, stride, descents);
  }

  // refine each remaining seed on all points; the smallest mean squared error wins
  std::optional<Refined> best;
  std::vector<std::size_t> winners;  // seeds
  std::vector<Pose> solutions;
  std::size_t most_inliers = 0;
  int iterations = 0;
  PointPairs::Neighborhoods neighborhoods;
  for (Descent& descent : descents) {
    const Refined refined = refine(pairs, weak, neighborhoods, descent);
    iterations += refined.iterations;
    most_inliers = std::max(most_inliers, refined.equations.inliers);
    if (!refined.usable) continue;
    solutions.push_back(refined.T_odom_cog);
    if (best && refined.error >= best->error) continue;
    best = refined;
    winners = descent.seeds;
  }
  recordEnds(descents, tracks);
  if (tracks != nullptr) {
    for (const std::size_t seed : winners) (*tracks)[seed].won = true;
  }
  if (!best) {
    result.inliers = most_inliers;
    result.iterations = std::max(iterations, 1);  // the search has run
    result.status = MeasurementStatus::kTooFewPoints;
    return result;
  }
  double spread2 = 0.0;
  for (const Pose& T : solutions) spread2 += (T.translation() - best->T_odom_cog.translation()).squaredNorm();
  result = measurement(*best, spread2 / static_cast<double>(solutions.size()));
  result.iterations = iterations;
  return result;
}

}  // namespace fail_aware
