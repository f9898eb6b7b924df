#include "core/initial_guess/motion_initialization.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/moving_median.hpp"
#include "core/preprocessing/voxel_filter.hpp"

namespace fail_aware {

namespace {

constexpr double kMostTried = 10000.0;
constexpr double kRounding = 1e-9;  // 0.7 / 0.1 is less than 7
// Probability that a place meets nothing at the right speed: it was hidden, or it moves. On 135 starts at highway speed
// and in open country 0.05 to 0.2 find the speed equally often.
constexpr double kUnmet = 0.1;
// The vote of a point that something hid from the first sweep: about that of a point that is seen twice. Of 120 starts
// on highways 115 find the speed if such a point counts as one that meets nothing, 118 with 0.5, 119 with 0.7 and 0.9.
constexpr double kHidden = 0.7;
constexpr double kFineKernel = 0.3;  // the kernel of the last search, as a ratio of kernel_m
// A cell with this vote meets the first sweep; at a true standstill at least this ratio of the cells does. In 57
// simulated starts from standstill (16 to 64 beams) it is 0.92 or more, with the wrong standstill of tunnels and of
// convoys 0.89 or less.
constexpr double kMet = 0.5, kStandingRatio = 0.9;

// The log likelihood of another speed must be above the median of all speeds by this much. In a smooth tunnel the best
// speed is above it by 2 to 8, on highways by 6 to 30.
constexpr double kStandsOut = 10.0;

double logLikelihood(const std::vector<double>& votes) {
  double sum = 0.0;
  for (const double vote : votes) sum += std::log(vote + kUnmet);
  return sum;
}

/// A motion and how well it fits.
struct Tried {
  Vector6d twist = Vector6d::Zero();
  double likelihood = -std::numeric_limits<double>::infinity();
  double votes = 0.0;
  double met_ratio = 0.0;  ///< of the cells

  bool operator<(const Tried& other) const { return likelihood < other.likelihood; }
};

/// Scores motions of one sweep against the first one.
struct Search {
  const MotionInitialization::Params& params;
  const AboveGroundPoints& standing;
  const VoxelMap& first;
  const OcclusionImage& hidden_in_first;
  double dt_s;

  Tried score(double speed_mps, double yaw_rate_rps, double kernel_m, double hidden) const {
    Tried tried;
    if (speed_mps < params.min_speed_mps || speed_mps > params.max_speed_mps ||
        std::abs(yaw_rate_rps) > params.max_yaw_rate_rps + kRounding ||
        std::abs(speed_mps * yaw_rate_rps) > params.max_lateral_acceleration_mps2) {
      return tried;
    }
    tried.twist[0] = speed_mps;
    tried.twist[5] = yaw_rate_rps;
    const std::vector<double> votes = votesOfPlaces(
        standing, first, expSe3(tried.twist * dt_s), kernel_m,
        [&](const Eigen::Vector3d& point) { return hidden > 0.0 && hidden_in_first.hides(point) ? hidden : 0.0; });
    tried.likelihood = logLikelihood(votes);
    tried.votes = std::accumulate(votes.begin(), votes.end(), 0.0);
    const auto met = std::count_if(votes.begin(), votes.end(), [](double vote) { return vote >= kMet; });
    if (!votes.empty()) tried.met_ratio = static_cast<double>(met) / static_cast<double>(votes.size());
    return tried;
  }

  /// The best yaw rate of each speed, from the lowest speed on.
  std::vector<Tried> bySpeed() const {
    const int speeds = static_cast<int>((params.max_speed_mps - params.min_speed_mps) / params.step_mps + kRounding);
    const int yaws = static_cast<int>(params.max_yaw_rate_rps / params.step_yaw_rate_rps + kRounding);
    std::vector<Tried> all;
    for (int i = 0; i <= speeds; ++i) {
      Tried best;
      for (int k = -yaws; k <= yaws; ++k) {
        best = std::max(best, score(params.min_speed_mps + i * params.step_mps, k * params.step_yaw_rate_rps,
                                    params.kernel_m, kHidden));
      }
      all.push_back(best);
    }
    return all;
  }

  /// Without a vote for what is hidden: one above that of a place that meets, though not within the narrow kernel,
  /// would draw the speed to where less is seen.
  Tried refined(const Tried& coarse) const {
    constexpr double kStep = MotionInitialization::kFineStep;
    Tried best;
    for (int i = -4; i <= 4; ++i) {
      for (int k = -4; k <= 4; ++k) {
        best = std::max(
            best, score(coarse.twist[0] + kStep * i * params.step_mps,
                        coarse.twist[5] + kStep * k * params.step_yaw_rate_rps, kFineKernel * params.kernel_m, 0.0));
      }
    }
    return best;
  }

  /// The best of the speeds that fit better than their neighbours, standstill aside, if it stands out.
  const Tried* movingPeak(const std::vector<Tried>& tried) const {
    const double slowest_mps = std::max(params.standstill_m / dt_s, 1.5 * params.step_mps);
    const Tried* peak = nullptr;
    for (std::size_t i = 1; i + 1 < tried.size(); ++i) {
      const bool fits = tried[i - 1] < tried[i] && tried[i + 1] < tried[i];
      if (fits && std::abs(tried[i].twist[0]) >= slowest_mps && (peak == nullptr || *peak < tried[i])) peak = &tried[i];
    }
    MovingMedian likelihoods(tried.size());
    for (const Tried& one : tried) likelihoods.add(one.likelihood);
    return peak != nullptr && peak->likelihood > likelihoods.median() + kStandsOut ? peak : nullptr;
  }
};

VoxelMap::Params denseMap(const MotionInitialization::Params& params) {
  VoxelMap::Params map;
  map.voxel_size_m = 4.0 * params.thinning_m;
  map.max_points = VoxelMap::kMaxPoints;
  map.min_point_spacing_m = 1.2 * params.thinning_m;
  return map;
}

}  // namespace

void MotionInitialization::Params::checkRules() const {
  requireWithin("max_speed_mps", max_speed_mps, min_speed_mps, 100.0);
  const double tried =
      ((max_speed_mps - min_speed_mps) / step_mps + 1.0) * (2.0 * max_yaw_rate_rps / step_yaw_rate_rps + 1.0);
  requireParameter(tried <= kMostTried, "max_yaw_rate_rps", max_yaw_rate_rps,
                   "so small that at most 10000 motions are tried");
}

MotionInitialization::MotionInitialization(const Params& params, double min_range_m)
    : params_(params), min_range_m_(min_range_m), first_(denseMap(params)) {}

std::vector<Eigen::Vector3f> MotionInitialization::thinned(const CorrectedSweep& sweep, const Pose& T_cog_lidar) const {
  VoxelFilter filter;
  const Eigen::Matrix3f R = T_cog_lidar.linear().cast<float>();
  const Eigen::Vector3f t = T_cog_lidar.translation().cast<float>();
  std::vector<Eigen::Vector3f> points_cog;
  for (const std::uint32_t i :
       filter.select(sweep.points_lidar, params_.thinning_m, min_range_m_, params_.max_range_m)) {
    points_cog.push_back(R * sweep.points_lidar[i] + t);
  }
  return points_cog;
}

void MotionInitialization::setFirst(const CorrectedSweep& sweep, const Pose& T_cog_lidar) {
  const std::vector<Eigen::Vector3f> points_cog = thinned(sweep, T_cog_lidar);
  first_.clear();
  first_.insert(points_cog, Pose::Identity());
  hidden_in_first_ = OcclusionImage(findAboveGroundPoints(points_cog, params_.above_ground, points_cog.size()),
                                    T_cog_lidar.translation());
}

std::optional<MotionInitialization::Found> MotionInitialization::find(const CorrectedSweep& sweep,
                                                                      const Pose& T_cog_lidar, double dt_s) const {
  if (first_.empty() || !(dt_s > 0.0)) return std::nullopt;
  constexpr std::size_t kEnough = 2000;
  const AboveGroundPoints standing = findAboveGroundPoints(thinned(sweep, T_cog_lidar), params_.above_ground, kEnough);
  const Search search{params_, standing, first_, hidden_in_first_, dt_s};
  const std::vector<Tried> tried = search.bySpeed();
  const auto best = std::max_element(tried.begin(), tried.end());
  if (best->votes <= 0.0) return std::nullopt;  // no above-ground points, or no match
  Tried found = search.refined(*best);
  const auto stands = [&] { return std::abs(found.twist[0]) * dt_s < params_.standstill_m; };
  if (stands()) {
    const Tried* moving = search.movingPeak(tried);
    // the standstill with the narrow kernel against the other with the wide one
    if (moving != nullptr && found < *moving) found = search.refined(*moving);
  }
  return Found{found.twist, found.votes, stands() && found.met_ratio >= kStandingRatio};
}

void MotionInitialization::reset() { first_.clear(); }

}  // namespace fail_aware
