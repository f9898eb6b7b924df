#include "core/aiding/above_ground_matcher.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/map/near_side.hpp"
#include "core/registration/plane_pairs.hpp"
#include "core/robust_kernel.hpp"

namespace fail_aware {

namespace {

constexpr std::size_t kMatched = 1000;  // points, about
constexpr double kWideKernel = 2.0;     // of the search, in kernels
constexpr int kIterations = 8;
constexpr double kLeastWindow_m = 0.4;   // however little was driven
constexpr std::size_t kLookedAt = 2000;  // points, about, for the planes' ratio

Pose movedAlong(const Pose& T_odom_cog, double distance_m) {
  Pose moved = T_odom_cog;
  moved.translation() += distance_m * T_odom_cog.linear().col(0);
  return moved;
}

// dx: x, y, yaw, as in fitted().
Pose stepped(const Pose& T_odom_cog, const Eigen::Vector3d& dx) {
  Vector6d step = Vector6d::Zero();
  step.head<2>() = dx.head<2>();
  step[5] = dx[2];
  return applyStep(T_odom_cog, step);
}

struct Fit {
  double votes = 0.0;
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
};

// How far each place's near side has moved since the kept sweep, odom.
std::vector<Eigen::Vector2d> nearSideShifts(const AboveGroundPoints& above_ground, const Pose& T_odom_cog,
                                            const Pose& T_odom_cog_kept) {
  std::vector<Eigen::Vector3d> sums(above_ground.places, Eigen::Vector3d::Zero());
  for (const AboveGroundPoint& point : above_ground.points) sums[point.place] += point.position;
  std::vector<Eigen::Vector2d> shifts(above_ground.places);
  for (std::size_t place = 0; place < above_ground.places; ++place) {
    const Eigen::Vector3d mean_odom = T_odom_cog * (sums[place] / above_ground.counts[place]);
    const auto directionFrom = [&](const Pose& T) -> Eigen::Vector2d {
      return (mean_odom - T.translation()).head<2>().normalized();
    };
    shifts[place] = nearSideShift(directionFrom(T_odom_cog_kept), directionFrom(T_odom_cog));
  }
  return shifts;
}

// Gauss-Newton's equations for x, y and yaw about the vehicle; a place weighs 1 at most.
Fit fitted(const AboveGroundPoints& above_ground, const std::vector<bool>& has_vote,
           const std::vector<Eigen::Vector2d>& shifts, const VoxelMap& kept, const Pose& T_odom_cog, double kernel_m) {
  Fit fit;
  VoxelMap::PointMatch match;
  for (const AboveGroundPoint& point : above_ground.points) {
    if (!has_vote[point.place]) continue;
    const Eigen::Vector3d arm = T_odom_cog.linear() * point.position;
    if (!kept.findNearest(arm + T_odom_cog.translation(), kFarthestInKernels * kernel_m, match)) continue;
    const double weight =
        gemanMcClureWeight(match.distance2_m2, kernel_m * kernel_m) / above_ground.counts[point.place];
    Eigen::Matrix<double, 2, 3> J;
    J << 1.0, 0.0, -arm.y(), 0.0, 1.0, arm.x();
    fit.votes += weight;
    fit.H += weight * J.transpose() * J;
    fit.b += weight * J.transpose() * (match.offset_m.head<2>().cast<double>() + shifts[point.place]);
  }
  return fit;
}

// The best place along the path, and which places have a vote.
std::optional<Pose> searchAlong(const AboveGroundMatcher::Params& params, const AboveGroundPoints& above_ground,
                                const AboveGroundReference& reference, const Pose& T_odom_cog_predicted,
                                std::vector<bool>& has_vote) {
  const double distance_m = (T_odom_cog_predicted.translation() - reference.T_odom_cog().translation()).norm();
  const double window_m = std::clamp(0.5 * distance_m, std::min(kLeastWindow_m, params.window_m), params.window_m);
  const int steps = static_cast<int>(window_m / params.step_m + 1e-9);
  const int beyond = steps + static_cast<int>(std::ceil(params.contrast_m / params.step_m));
  const auto tried = [&](int i) { return movedAlong(T_odom_cog_predicted, i * params.step_m); };
  std::vector<std::vector<double>> profile;
  for (int i = -beyond; i <= beyond; ++i) {
    profile.push_back(votesOfPlaces(above_ground, reference.map(), tried(i), kWideKernel * params.kernel_m));
  }
  has_vote.assign(above_ground.places, false);
  for (std::size_t place = 0; place < above_ground.places; ++place) {
    const auto less = [&](const std::vector<double>& a, const std::vector<double>& b) { return a[place] < b[place]; };
    const auto [least, most] = std::minmax_element(profile.begin(), profile.end(), less);
    has_vote[place] = (*most)[place] - (*least)[place] >= params.min_contrast;
  }
  int best = 0;
  double best_votes = 0.0;
  for (int i = -steps; i <= steps; ++i) {
    double sum = 0.0;
    const std::vector<double>& all = profile[static_cast<std::size_t>(i + beyond)];
    for (std::size_t place = 0; place < above_ground.places; ++place) sum += has_vote[place] ? all[place] : 0.0;
    if (sum > best_votes) {
      best_votes = sum;
      best = i;
    }
  }
  if (best_votes < params.min_places) return std::nullopt;
  return tried(best);
}

}  // namespace

double AboveGroundMatcher::ratioOfPlanes(const std::vector<Eigen::Vector3f>& points_cog, const VoxelMap& map,
                                         const Pose& T_odom_cog_predicted, double sigma_yaw_rad) const {
  const std::size_t stride = 1 + points_cog.size() / kLookedAt;
  PlanePairs pairs(planes_, points_cog, map, T_odom_cog_predicted, sigma_yaw_rad, stride);
  return horizontalRatios(pairs.linearize(T_odom_cog_predicted, planes_.initial_kernel_m)).strongest;
}

// The kept sweep reaches farther on all sides: where a fence is cut off is not where it ends.
AboveGroundPoints AboveGroundMatcher::select(const std::vector<Eigen::Vector3f>& points_cog) const {
  const double range_m =
      params_.reference.max_range_m - params_.reference.max_distance_m - params_.window_m - params_.contrast_m;
  return findAboveGroundPoints(pointsWithin(points_cog, range_m), params_.reference.points, kMatched);
}

std::optional<AboveGroundPose> AboveGroundMatcher::find(const AboveGroundPoints& above_ground_cog,
                                                        const AboveGroundReference& reference,
                                                        const Pose& T_odom_cog_predicted) const {
  if (reference.map().empty()) return std::nullopt;
  std::vector<bool> has_vote;
  std::optional<Pose> T = searchAlong(params_, above_ground_cog, reference, T_odom_cog_predicted, has_vote);
  if (!T) return std::nullopt;
  const std::vector<Eigen::Vector2d> shifts = nearSideShifts(above_ground_cog, *T, reference.T_odom_cog());
  double kernel_m = kWideKernel * params_.kernel_m;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Fit at = fitted(above_ground_cog, has_vote, shifts, reference.map(), *T, kernel_m);
    if (at.votes < params_.min_places) return std::nullopt;
    T = stepped(*T, at.H.ldlt().solve(at.b));
    kernel_m = std::max(0.5 * kernel_m, params_.kernel_m);
  }
  const Fit at = fitted(above_ground_cog, has_vote, shifts, reference.map(), *T, params_.kernel_m);
  if (at.votes < params_.min_places || !isFinite(*T)) return std::nullopt;
  const Eigen::Matrix3d covariance = params_.sigma_m * params_.sigma_m * at.H.inverse();
  if (!covariance.allFinite()) return std::nullopt;
  return AboveGroundPose{*T, covariance};
}

}  // namespace fail_aware
