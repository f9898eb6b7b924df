#include "core/initial_guess/drive_off.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace fail_aware {

namespace {

constexpr double kFirst_m = -1.0, kLast_m = 8.0, kDistanceStep_m = 0.2, kFineStep_m = 0.05;
constexpr double kNextTo_m = 0.7;  // of one peak
// Of the log likelihood, for each place. On highways and in open country the true distance is above all others by 0.1
// to 2, in tunnels a wrong one by less than 0.1 in 15 of 16 cases.
constexpr double kPeakPerPlace = 0.1;
constexpr double kDroveOff = 3.0;   // of the log likelihood, above that of the standstill next to it
constexpr double kNearest_m = 0.2;  // nearer ones are hardly told from a standstill

// The vehicle stands if this ratio of the places meets: when that is first asked, and from then on. A vehicle that
// drives off moves by centimetres before it is first asked.
constexpr double kBeginsToStand = 0.8, kStillStands = 0.9;
constexpr double kFirstAsked_s = 0.18, kLastAsked_s = 0.35;  // s since the first sweep: when the following may begin
constexpr double kLeft_m = 7.0;                              // farther away the vehicle has left the start
constexpr double kLongestWithout_s = 0.85;                   // without a distance, the vehicle is lost
constexpr double kLastAsked_sweeps = 2.2;                    // at 5 Hz the motion is known from 0.4 s on
constexpr double kBegins_m = 1.5;  // farther ahead, the search for the first motion found a speed
constexpr double kBack_m = 0.15;   // a vehicle that drives off does not come back; in tunnels, wrong distances do
constexpr double kStandingSigma_m = 0.02, kDistanceSigma_m = 0.05;
constexpr double kDriveOff_mps2 = 3.0;

struct DistanceTried {
  double distance_m = 0.0;
  double log_likelihood = -std::numeric_limits<double>::infinity();

  bool operator<(const DistanceTried& other) const { return log_likelihood < other.log_likelihood; }
};

struct DistanceSearch {
  const FirstSweepMatcher& matcher;
  double turned_rad;

  FirstSweepMatch match(double distance_m, double kernel_m, HiddenPoints hidden) const {
    Vector6d step = Vector6d::Zero();
    step[0] = distance_m;
    step[5] = turned_rad;
    return matcher.match(expSe3(step), kernel_m, hidden);
  }

  DistanceTried best(double from_m, double to_m, double step_m, double kernel_m, HiddenPoints hidden,
                     std::vector<DistanceTried>* all = nullptr) const {
    DistanceTried best;
    const int steps = static_cast<int>(std::lround((to_m - from_m) / step_m));
    for (int i = 0; i <= steps; ++i) {
      const double distance_m = from_m + i * step_m;
      const DistanceTried tried{distance_m, match(distance_m, kernel_m, hidden).log_likelihood};
      best = std::max(best, tried);
      if (all != nullptr) all->push_back(tried);
    }
    return best;
  }
};

}  // namespace

std::optional<double> findDrivenOff(const FirstSweepMatcher& matcher, const DistanceKernels& kernels, double turned_rad,
                                    double standing_ratio) {
  if (matcher.places() == 0.0) return std::nullopt;
  const FirstSweepMatch here = matcher.match(Pose::Identity(), kernels.fine_m, HiddenPoints::kMeetNothing);
  if (here.met_ratio >= standing_ratio) return 0.0;
  const DistanceSearch search{matcher, turned_rad};
  std::vector<DistanceTried> all;
  const DistanceTried coarse =
      search.best(kFirst_m, kLast_m, kDistanceStep_m, kernels.coarse_m, HiddenPoints::kHaveAVote, &all);
  const double least = coarse.log_likelihood - kPeakPerPlace * matcher.places();
  const bool ambiguous = std::any_of(all.begin(), all.end(), [&](const DistanceTried& other) {
    return std::abs(other.distance_m - coarse.distance_m) > kNextTo_m && other.log_likelihood > least;
  });
  const bool at_the_edge = coarse.distance_m < kFirst_m + kFineStep_m || coarse.distance_m > kLast_m - kFineStep_m;
  if (ambiguous || at_the_edge) return std::nullopt;
  const DistanceTried fine =
      search.best(coarse.distance_m - 2.0 * kDistanceStep_m, coarse.distance_m + 2.0 * kDistanceStep_m, kFineStep_m,
                  kernels.fine_m, HiddenPoints::kMeetNothing);
  const bool next_to_here = std::abs(coarse.distance_m) <= kNextTo_m;
  if (next_to_here && fine.log_likelihood < here.log_likelihood + kDroveOff) return std::nullopt;
  if (std::abs(fine.distance_m) < kNearest_m) return std::nullopt;
  return fine.distance_m;
}

std::optional<DriveOff::Place> DriveOff::add(const Sweep& sweep, const Search& search) {
  if (std::abs(sweep.predicted_m) > kLeft_m) clear();
  const double last_asked_s = std::max(kLastAsked_s, kLastAsked_sweeps * sweep.dt_s);
  const bool may_begin = sweep.since_first_s >= kFirstAsked_s && sweep.since_first_s <= last_asked_s &&
                         std::abs(sweep.predicted_m) <= kBegins_m;
  if (state_ == State::kIdle && !may_begin) return std::nullopt;
  const double without_s = sweep.since_first_s - found_after_s_;
  const double gone_m = 0.5 * kDriveOff_mps2 * without_s * without_s;
  std::optional<double> distance_m;
  if (state_ != State::kLost) distance_m = search(state_ == State::kIdle ? kBeginsToStand : kStillStands);
  if (state_ == State::kIdle && distance_m != 0.0) return std::nullopt;
  if (distance_m && std::abs(*distance_m) < farthest_m_ - kBack_m) {
    state_ = State::kLost;
    distance_m.reset();
  }
  stands_ = distance_m == 0.0;
  if (distance_m) {
    state_ = State::kFollowing;
    farthest_m_ = std::max(farthest_m_, std::abs(*distance_m));
    found_after_s_ = sweep.since_first_s;
    return Place{distance_m, stands_ ? kStandingSigma_m : kDistanceSigma_m};
  }
  if (without_s > kLongestWithout_s) state_ = State::kLost;
  // registration makes the same error in each of these sweeps: together they must not weigh more than one
  return Place{std::nullopt, std::sqrt(std::max(1.0, without_s / sweep.dt_s)) * (kDistanceSigma_m + gone_m)};
}

}  // namespace fail_aware
