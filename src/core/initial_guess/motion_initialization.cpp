#include "core/initial_guess/motion_initialization.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/initial_guess/drive_off.hpp"
#include "core/initial_guess/first_sweep_matcher.hpp"
#include "core/moving_median.hpp"
#include "core/preprocessing/voxel_filter.hpp"

namespace fail_aware {

namespace {

constexpr double kMostTried = 10000.0;
constexpr double kRounding = 1e-9;   // 0.7 / 0.1 is less than 7
constexpr double kFineKernel = 0.3;  // the kernel of the last search, as a ratio of kernel_m
// The log likelihood of another speed must be above the median of all speeds by this much. In a smooth tunnel the best
// speed is above it by 2 to 8, on highways by 6 to 30.
constexpr double kStandsOut = 10.0;

/// A motion and how well it fits.
struct Tried {
  Vector6d twist = Vector6d::Zero();
  double likelihood = -std::numeric_limits<double>::infinity();
  double votes = 0.0;

  bool operator<(const Tried& other) const { return likelihood < other.likelihood; }
};

/// Scores motions of one sweep against the first one.
struct Search {
  const MotionInitialization::Params& params;
  const FirstSweepMatcher& matcher;
  double dt_s;

  Tried score(double speed_mps, double yaw_rate_rps, double kernel_m, HiddenPoints hidden) const {
    Tried tried;
    if (speed_mps < params.min_speed_mps || speed_mps > params.max_speed_mps ||
        std::abs(yaw_rate_rps) > params.max_yaw_rate_rps + kRounding ||
        std::abs(speed_mps * yaw_rate_rps) > params.max_lateral_acceleration_mps2) {
      return tried;
    }
    tried.twist[0] = speed_mps;
    tried.twist[5] = yaw_rate_rps;
    const FirstSweepMatch match = matcher.match(expSe3(tried.twist * dt_s), kernel_m, hidden);
    tried.likelihood = match.log_likelihood;
    tried.votes = match.votes;
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
                                    params.kernel_m, HiddenPoints::kHaveAVote));
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
        best = std::max(best, score(coarse.twist[0] + kStep * i * params.step_mps,
                                    coarse.twist[5] + kStep * k * params.step_yaw_rate_rps,
                                    kFineKernel * params.kernel_m, HiddenPoints::kMeetNothing));
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

AboveGroundPoints MotionInitialization::aboveGround(const CorrectedSweep& sweep, const Pose& T_cog_lidar,
                                                    std::size_t enough) const {
  return findAboveGroundPoints(thinned(sweep, T_cog_lidar), params_.above_ground, enough);
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
  const AboveGroundPoints above_ground = aboveGround(sweep, T_cog_lidar, 2000);
  const FirstSweepMatcher matcher(above_ground, first_, hidden_in_first_);
  const Search search{params_, matcher, dt_s};
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
  return Found{found.twist, found.votes};
}

std::optional<double> MotionInitialization::findDistance(const CorrectedSweep& sweep, const Pose& T_cog_lidar,
                                                         double turned_rad, double standing_ratio) const {
  if (first_.empty()) return std::nullopt;
  const AboveGroundPoints above_ground = aboveGround(sweep, T_cog_lidar, 1000);
  const FirstSweepMatcher matcher(above_ground, first_, hidden_in_first_);
  return findDrivenOff(matcher, {params_.kernel_m, kFineKernel * params_.kernel_m}, turned_rad, standing_ratio);
}

void MotionInitialization::reset() { first_.clear(); }

}  // namespace fail_aware
