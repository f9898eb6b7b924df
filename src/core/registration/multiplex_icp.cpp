#include "fail_aware_lidar_odometry/core/registration/multiplex_icp.hpp"

#include <algorithm>
#include <cmath>

#include "fail_aware_lidar_odometry/core/geometry/degree.hpp"
#include "fail_aware_lidar_odometry/core/geometry/rotation.hpp"
#include "fail_aware_lidar_odometry/core/parallel.hpp"
#include "fail_aware_lidar_odometry/core/parameters/check.hpp"
#include "fail_aware_lidar_odometry/core/robust_kernel.hpp"

namespace fail_aware {

namespace {

struct Descent {
  Pose T;
  std::vector<std::size_t> seeds;  ///< that have come together here
  bool settled = false;
  std::vector<VoxelMap::Neighborhood>
      neighborhoods;  ///< of the few points that are used as long as there are many seeds
};

void recordEnds(const std::vector<Descent>& descents, std::vector<SeedTrack>* tracks) {
  if (tracks == nullptr) return;
  for (const Descent& descent : descents) {
    for (const std::size_t seed : descent.seeds) (*tracks)[seed].T_odom_cog_end = descent.T;
  }
}

/// False: a pair with this surface informs on no direction.
template <class Inform>
bool forEachInformedDirection(const PlanePatch& surface, Inform inform) {
  if (surface.samples > 0.0f) {
    inform(surface.normal.cast<double>());
    return true;
  }
  if (!surface.post) return false;
  inform(Eigen::Vector3d::UnitX());
  inform(Eigen::Vector3d::UnitY());
  return true;
}

constexpr std::size_t kBlock = 1000;  // points at most that are summed in one go; blocks may run beside each other

// Sums over pairs: those of `equations` and what the rest is made of.
struct PairSums {
  NormalEquations equations;
  double w = 0.0;
  Eigen::Vector3d w_arm = Eigen::Vector3d::Zero();
  Eigen::Matrix3d w_arm_arm = Eigen::Matrix3d::Zero();

  PairSums operator+(const PairSums& other) const {
    PairSums sum = *this;
    sum.w += other.w;
    sum.w_arm += other.w_arm;
    sum.w_arm_arm += other.w_arm_arm;
    NormalEquations& e = sum.equations;
    e.b += other.equations.b;
    e.information += other.equations.information;
    e.information_b += other.equations.information_b;
    e.information_weight += other.equations.information_weight;
    e.squared_error += other.equations.squared_error;
    e.inliers += other.equations.inliers;
    return sum;
  }
};

bool sameBasin(const Pose& a, const Pose& b, const MultiplexIcp::Params& params) {
  return (a.translation() - b.translation()).norm() < params.merge_translation_m &&
         logSo3(a.linear().transpose() * b.linear()).norm() < params.merge_rotation_deg * kDegree;
}

}  // namespace

void MultiplexIcp::Params::validate() const {
  requireWithin("seeds", seeds, 1, 8);
  requirePositive("spread", spread);
  requireNotNegative("min_spread_m", min_spread_m);
  requireNotNegative("min_spread_deg", min_spread_deg);
  requireParameter(max_spread_m >= min_spread_m, "max_spread_m", max_spread_m, ">= min_spread_m");
  requireAtMost("max_spread_m", max_spread_m, kLargestSpread_m);
  requireParameter(max_spread_deg >= min_spread_deg, "max_spread_deg", max_spread_deg, ">= min_spread_deg");
  requireAtMost("max_spread_deg", max_spread_deg, 180.0);
  requireWithin("thinned_points", thinned_points, 10, 1e9);
  requirePositive("max_distance_m", max_distance_m);
  requirePositive("kernel_m", kernel_m);
  requirePositive("initial_kernel_m", initial_kernel_m);
  requireNotNegative("merge_translation_m", merge_translation_m);
  requireNotNegative("merge_rotation_deg", merge_rotation_deg);
  requireWithin("max_joint_iterations", max_joint_iterations, 1, 1000);
  requireWithin("max_refined_seeds", max_refined_seeds, 1, 8);
  requireWithin("max_iterations", max_iterations, 1, kMostIterations);
  requirePositive("step_translation_m", step_translation_m);
  requirePositive("step_rotation_deg", step_rotation_deg);
  requireWithin("usable_steps", usable_steps, 1.0, 1e6);
  requireWithin("min_inlier_share", min_inlier_share, 0.0, 1.0);
  requireWithin("min_inliers", min_inliers, 6, 1e9);
  requireWithin("correlation_inflation", correlation_inflation, 1.0, 1e6);
  support.validate();
  observability.validate();
}

MultiplexIcp::MultiplexIcp(const Params& params) : params_(params) { params_.validate(); }

std::vector<Pose> MultiplexIcp::seeds(const Pose& T_odom_cog_predicted, const Matrix6d& predicted_covariance) const {
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

bool MultiplexIcp::stepWithin(const Vector6d& dx, double factor) const {
  return dx.head<3>().norm() < factor * params_.step_translation_m &&
         dx.tail<3>().norm() < factor * params_.step_rotation_deg * kDegree;
}

NormalEquations MultiplexIcp::linearize(const std::vector<Eigen::Vector3f>& points_cog, std::size_t stride,
                                        const VoxelMap& map, const Pose& T_odom_cog, double kernel_m,
                                        Neighborhoods& neighborhoods) const {
  const Eigen::Matrix3d R = T_odom_cog.linear();
  const Eigen::Vector3d t = T_odom_cog.translation();
  const double kernel2 = kernel_m * kernel_m;
  // residual e = p - (R q + t); moved by -dt - dr x arm, so J = [I, -[arm]x] acts on -e
  const auto add = [&](std::size_t k, PairSums& sums) {
    VoxelMap::PointMatch match;
    const Eigen::Vector3d arm = R * points_cog[k * stride].cast<double>();
    if (!map.findNearest(arm + t, params_.max_distance_m, match, neighborhoods[k])) return;
    const double e2 = match.distance2_m2;
    const Eigen::Vector3d e = match.offset_m.cast<double>();
    const double w = gemanMcClureWeight(e2, kernel2);
    NormalEquations& equations = sums.equations;
    sums.w += w;
    sums.w_arm += w * arm;
    sums.w_arm_arm.selfadjointView<Eigen::Lower>().rankUpdate(arm, w);
    equations.b.head<3>() += w * e;
    equations.b.tail<3>() += w * arm.cross(e);
    equations.squared_error += w * e2;
    ++equations.inliers;
    if (!params_.surface_information) return;
    const auto inform = [&](const Eigen::Vector3d& n) {
      Vector6d J;
      J << n, arm.cross(n);
      equations.information.selfadjointView<Eigen::Lower>().rankUpdate(J, w);
      equations.information_b += w * n.dot(e) * J;
    };
    if (forEachInformedDirection(map.surface(match.voxel), inform)) equations.information_weight += w;
  };
  // the blocks do not depend on the number of threads, nor does the order in which they are added up
  neighborhoods.resize((points_cog.size() + stride - 1) / stride);
  const auto sums = sumByHalves<PairSums>(0, neighborhoods.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    PairSums of_block;
    for (std::size_t k = begin; k != end; ++k) {
      if (k + VoxelMap::kPrefetchAhead < end) map.prefetchPoints(neighborhoods[k + VoxelMap::kPrefetchAhead]);
      add(k, of_block);
    }
    return of_block;
  });

  NormalEquations equations = sums.equations;
  equations.has_information = equations.slides = params_.surface_information;
  equations.information = equations.information.selfadjointView<Eigen::Lower>();
  if (equations.information_weight > 0.0) {  // pairs whose surface is not known inform as the others do
    const double all = sums.w / equations.information_weight;
    equations.information *= all;
    equations.information_b *= all;
    equations.information_weight = sums.w;
  }
  const Eigen::Matrix3d w_arm_arm = sums.w_arm_arm.selfadjointView<Eigen::Lower>();
  equations.H.topLeftCorner<3, 3>().diagonal().setConstant(sums.w);
  equations.H.topRightCorner<3, 3>() = -skew(sums.w_arm);
  equations.H.bottomLeftCorner<3, 3>() = skew(sums.w_arm);
  equations.H.bottomRightCorner<3, 3>() = w_arm_arm.trace() * Eigen::Matrix3d::Identity() - w_arm_arm;
  equations.weight = sums.w;
  equations.weight_unscaled = sums.w;
  return equations;
}

std::optional<MultiplexIcp::WeakHorizontal> MultiplexIcp::weakHorizontal(const std::vector<Eigen::Vector3f>& points_cog,
                                                                         const VoxelMap& map, const Pose& T_odom_cog,
                                                                         Neighborhoods& neighborhoods) const {
  if (!params_.surface_information) return std::nullopt;
  const NormalEquations equations =
      linearize(points_cog, thinningStride(points_cog), map, T_odom_cog, params_.initial_kernel_m, neighborhoods);
  const Eigen::Matrix2d horizontal = equations.information.topLeftCorner<2, 2>();
  if (!(equations.information_weight > 0.0)) return std::nullopt;
  WeakHorizontal weak;
  weak.direction = weakestHorizontal(horizontal);
  if (weak.direction.dot(horizontal * weak.direction) > params_.support.below_share * equations.information_weight) {
    return std::nullopt;
  }
  InformationSupport support(params_.support);
  VoxelMap::PointMatch match;
  const double kernel2 = params_.initial_kernel_m * params_.initial_kernel_m;
  for (const Eigen::Vector3f& point : points_cog) {
    const Eigen::Vector3d p = T_odom_cog * point.cast<double>();
    if (!map.findNearest(p, params_.max_distance_m, match)) continue;
    const double w = gemanMcClureWeight(match.distance2_m2, kernel2);
    forEachInformedDirection(map.surface(match.voxel), [&](const Eigen::Vector3d& n) {
      const double along = weak.direction.dot(n.head<2>());
      support.add(p, w * along * along);
    });
  }
  weak.counted_share = support.countedShare();
  return weak;
}

Solution MultiplexIcp::solve(NormalEquations& equations, const std::optional<WeakHorizontal>& weak) const {
  if (weak) discount(equations, weak->direction, weak->counted_share);
  return solveObserved(equations, params_.observability);
}

std::size_t MultiplexIcp::thinningStride(const std::vector<Eigen::Vector3f>& points_cog) const {
  return std::max<std::size_t>(1, points_cog.size() / static_cast<std::size_t>(params_.thinned_points));
}

Measurement MultiplexIcp::align(const std::vector<Eigen::Vector3f>& points_cog, const VoxelMap& map,
                                const Pose& T_odom_cog_predicted, const Matrix6d& predicted_covariance,
                                std::vector<SeedTrack>* tracks) const {
  Measurement result;
  result.T_odom_cog = T_odom_cog_predicted;
  if (tracks != nullptr) tracks->clear();
  if (map.empty()) return result;

  Neighborhoods around_prediction;  // of the few points that the seeds descend on together
  const std::optional<WeakHorizontal> weak = weakHorizontal(points_cog, map, T_odom_cog_predicted, around_prediction);
  std::vector<Descent> descents;
  for (const Pose& seed : seeds(T_odom_cog_predicted, predicted_covariance)) {
    descents.push_back({seed, {descents.size()}, false, around_prediction});
    if (tracks != nullptr) tracks->push_back({seed, seed, false});
  }

  // together, on few points, until settled or merged
  if (descents.size() > 1) {
    const std::size_t stride = thinningStride(points_cog);
    double kernel_m = std::max(params_.initial_kernel_m, params_.kernel_m);
    for (int iteration = 0; iteration < params_.max_joint_iterations; ++iteration) {
      inParallelFor(descents.size(), [&](std::size_t i) {
        Descent& descent = descents[i];
        if (descent.settled) return;
        NormalEquations equations = linearize(points_cog, stride, map, descent.T, kernel_m, descent.neighborhoods);
        const Solution step = solve(equations, weak);
        descent.T = applyStep(descent.T, step.dx);
        descent.settled = kernel_m <= params_.kernel_m && stepWithin(step.dx, 5.0);  // refinement follows
      });
      const bool all_settled =
          std::all_of(descents.begin(), descents.end(), [](const Descent& descent) { return descent.settled; });
      for (std::size_t i = 1; i < descents.size();) {
        const auto end = descents.begin() + static_cast<std::ptrdiff_t>(i);
        const auto met = std::find_if(descents.begin(), end,
                                      [&](const Descent& other) { return sameBasin(other.T, descents[i].T, params_); });
        if (met != end) {
          met->seeds.insert(met->seeds.end(), descents[i].seeds.begin(), descents[i].seeds.end());
          descents.erase(descents.begin() + static_cast<std::ptrdiff_t>(i));
        } else {
          ++i;
        }
      }
      if (all_settled || descents.size() == 1) break;
      kernel_m = std::max(0.5 * kernel_m, params_.kernel_m);
    }
    // the most promising survivors, by mean squared error with misses counted at the cut-off
    const auto score = [&](Descent& d) {
      const NormalEquations e = linearize(points_cog, stride, map, d.T, params_.kernel_m, d.neighborhoods);
      const auto used = static_cast<double>(d.neighborhoods.size());
      return (e.squared_error + (used - e.weight_unscaled) * params_.max_distance_m * params_.max_distance_m) / used;
    };
    recordEnds(descents, tracks);
    if (static_cast<int>(descents.size()) > params_.max_refined_seeds) {
      std::vector<std::pair<double, std::size_t>> scores;
      for (std::size_t i = 0; i < descents.size(); ++i) scores.emplace_back(score(descents[i]), i);
      std::sort(scores.begin(), scores.end());
      std::vector<Descent> best;
      best.reserve(static_cast<std::size_t>(params_.max_refined_seeds));
      for (int i = 0; i < params_.max_refined_seeds; ++i) {
        best.push_back(descents[scores[static_cast<std::size_t>(i)].second]);
      }
      descents.swap(best);
    }
  }

  // each survivor on all points; the best mean squared error wins
  double best_error = 0.0;
  bool best_converged = false;
  Vector6d best_step = Vector6d::Zero();
  NormalEquations best_equations;
  std::vector<Pose> solutions;
  std::vector<std::size_t> winners;  // seeds
  std::size_t most_inliers = 0;
  Neighborhoods neighborhoods;
  for (Descent& descent : descents) {
    NormalEquations equations;
    bool converged = false;
    Solution step;
    int iteration = 0;
    for (; iteration < params_.max_iterations && !converged; ++iteration) {
      equations = linearize(points_cog, 1, map, descent.T, params_.kernel_m, neighborhoods);
      if (static_cast<int>(equations.inliers) < params_.min_inliers) break;
      step = solve(equations, weak);
      if (step.weak_directions == 6) break;
      descent.T = applyStep(descent.T, step.dx);
      converged = stepWithin(step.dx, 1.0);
    }
    result.iterations += iteration;
    const double share =
        static_cast<double>(equations.inliers) / static_cast<double>(std::max<std::size_t>(points_cog.size(), 1));
    most_inliers = std::max(most_inliers, equations.inliers);
    if (static_cast<int>(equations.inliers) < params_.min_inliers || share < params_.min_inlier_share) continue;
    solutions.push_back(descent.T);
    const double cut2 = params_.max_distance_m * params_.max_distance_m;
    const double all = static_cast<double>(points_cog.size());
    const double error = (equations.squared_error + (all - equations.weight_unscaled) * cut2) / all;
    if (solutions.size() > 1 && error >= best_error) continue;
    best_error = error;
    winners = descent.seeds;
    best_converged = converged;
    best_step = step.dx;
    best_equations = equations;
    result.T_odom_cog = descent.T;
    result.inliers = equations.inliers;
    result.inlier_share = share;
    result.weak_directions = step.weak_directions;
    result.min_information_share = step.min_horizontal_share;
    result.rms_residual_m = std::sqrt(equations.squared_error / std::max(equations.weight_unscaled, 1e-9));
  }
  recordEnds(descents, tracks);
  if (tracks != nullptr) {
    for (const std::size_t seed : winners) (*tracks)[seed].won = true;
  }
  if (solutions.empty()) {
    result.T_odom_cog = T_odom_cog_predicted;
    result.inliers = most_inliers;
    result.iterations = std::max(result.iterations, 1);  // it has looked
    result.status = MeasurementStatus::kTooFewPoints;
    return result;
  }
  double spread2 = 0.0;
  for (const Pose& T : solutions) spread2 += (T.translation() - result.T_odom_cog.translation()).squaredNorm();
  spread2 /= static_cast<double>(solutions.size());
  result.seed_spread_m = std::sqrt(spread2);
  const double residual_variance = result.rms_residual_m * result.rms_residual_m / 3.0;
  result.covariance =
      covarianceObserved(best_equations, params_.correlation_inflation * residual_variance, params_.observability);
  result.covariance.topLeftCorner<3, 3>().diagonal().array() += spread2 / 3.0;
  const bool usable = best_converged || stepWithin(best_step, params_.usable_steps) ||
                      isWithinSigma(best_step, result.covariance);  // wanders where little is observed
  if (!best_converged) result.covariance += best_step * best_step.transpose();
  result.status = usable ? MeasurementStatus::kOk : MeasurementStatus::kNotConverged;
  return result;
}

}  // namespace fail_aware
