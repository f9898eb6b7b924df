#include "core/initial_guess/clock_jump_detector.hpp"

#include <algorithm>

#include "core/geometry/pose.hpp"

namespace fail_aware {

namespace {

constexpr double kUnusual = 1.5;        // an interval this many times longer or shorter than usual may be wrong
constexpr int kUsualEvery = 10;         // sweeps
constexpr std::size_t kMaxUnusual = 3;  // up to this many unusual intervals, each is tried by itself
// Least ratios of inliers and of information at a pose, relative to the usual values.
constexpr double kRatio = 0.7, kInformation = 0.4;  // if there is another pose to compare with
constexpr double kInformationNothingFits = 0.7;     // instead of kInformation if nothing fits at the other pose, or:
// If there is no other pose. In simulated drives the right pose has an inlier ratio + 0.25 information of 1.05 and an
// information of 0.39 or more; wrong poses that registration finds have at most 0.88, and as much information where
// less fits.
constexpr double kAlone = 0.97, kInformationWeight = 0.25, kInformationAlone = 0.35;
constexpr double kClearlyMore = 1.5;  // times the information at the pose from the stamps
// Below these ratios to the usual values, registration has most likely found a wrong pose: none of 5712 sweeps of
// simulated drives without a jump is below both.
constexpr double kMisfitRatio = 0.85, kMisfitInformation = 0.3;
constexpr double kSearched_m = 15.0;  // the relocalization reaches as far
constexpr double kSearchStep_m = 0.7;
constexpr double kLeastSearched_mps = 1.5;  // a slower vehicle is within reach of the registration
constexpr double kSamePlace_m = 0.2;
constexpr double kMaxMoved_m = 0.3;       // from the distance driven in the right interval to the registered pose,
constexpr double kDriver_mps2 = 3.0;      // plus the effect of an acceleration in the meantime,
constexpr double kMaxMovedAtAll_m = 1.0;  // but not more than this

double distance_m(const Pose& a, const Pose& b) { return (a.translation() - b.translation()).norm(); }

}  // namespace

// Possible times since the last inserted pose, given the doubts about the stamps; empty without doubts.
std::vector<double> ClockJumpDetector::otherTimes_s(const Interval& interval, double usual_s) {
  std::vector<Stamps> all = interval.unplaced;
  all.push_back(interval.stamps);
  double by_the_stamps_s = 0.0, if_usual_s = 0.0, if_set_back_s = 0.0;
  std::vector<double> unusual_s;
  for (const Stamps& stamps : all) {
    const bool is_unusual = stamps.dt_s > kUnusual * usual_s || kUnusual * stamps.dt_s < usual_s;
    if (is_unusual) unusual_s.push_back(stamps.dt_s);
    by_the_stamps_s += stamps.dt_s;
    if_usual_s += is_unusual ? usual_s : stamps.dt_s;
    // the refused stamp came one usual interval after the last one
    if (stamps.set_back_s > 0.0) if_set_back_s += usual_s + stamps.set_back_s;
  }
  std::vector<double> times_s;
  if (!unusual_s.empty()) times_s.push_back(if_usual_s);
  // one interval is wrong; in the others sweeps were lost
  if (unusual_s.size() > 1 && unusual_s.size() <= kMaxUnusual) {
    for (const double wrong_s : unusual_s) times_s.push_back(by_the_stamps_s - wrong_s + usual_s);
  }
  if (if_set_back_s > 0.0) times_s.push_back(by_the_stamps_s + if_set_back_s);
  return times_s;
}

// Sweeps were lost while the clock was set: any time is possible that the vehicle may have driven.
std::vector<double> ClockJumpDetector::allTimes_s(const Interval& interval, double usual_s) {
  double by_the_stamps_s = interval.stamps.dt_s;
  for (const Stamps& stamps : interval.unplaced) by_the_stamps_s += stamps.dt_s;
  const double speed_mps = interval.twist_cog.head<3>().norm();
  std::vector<double> times_s;
  if (speed_mps < kLeastSearched_mps) return times_s;
  const double least_s = usual_s * static_cast<double>(interval.unplaced.size() + 1);
  const double first_s = std::max(least_s, by_the_stamps_s - kSearched_m / speed_mps);
  const double last_s = by_the_stamps_s + kSearched_m / speed_mps;
  for (double time_s = first_s; time_s <= last_s; time_s += kSearchStep_m / speed_mps) times_s.push_back(time_s);
  return times_s;
}

std::optional<Pose> ClockJumpDetector::findOther(const Interval& interval, const Fit& fit) {
  const double dt_s = interval.stamps.dt_s;
  if (!(dt_s > 0.0)) return std::nullopt;
  const double usual_s = intervals_s_.size() > 0 ? intervals_s_.median() : dt_s;
  const std::vector<double> other_times_s = otherTimes_s(interval, usual_s);
  const bool is_doubtful = !other_times_s.empty(), follows = interval.unplaced.empty();
  if (!follows && is_doubtful && !usual_.observed) return std::nullopt;  // no usual values to compare with

  std::optional<Place> by_the_stamps;
  if (interval.T_odom_cog_by_the_stamps && (is_doubtful || --sweeps_to_usual_ <= 0)) {
    by_the_stamps = placeFrom(*interval.T_odom_cog_by_the_stamps, fit);
  }
  const auto bestOf = [&](const std::vector<double>& times_s) {
    Place best;
    for (const double driven_s : times_s) {
      const Place place = placeFrom(interval.T_odom_cog_placed * expSe3(interval.twist_cog * driven_s), fit);
      if (place.information <= best.information) continue;
      const double reach_m = std::min(kMaxMoved_m + 0.5 * kDriver_mps2 * driven_s * driven_s, kMaxMovedAtAll_m);
      const double clearly_m = follows ? kMaxMoved_m : reach_m;
      if (isRight(place, reach_m, clearly_m, by_the_stamps, interval.T_odom_cog_predicted)) best = place;
    }
    return best;
  };
  Place other = bestOf(other_times_s);
  if (other.ratio == 0.0 && is_doubtful && by_the_stamps && isMisfit(*by_the_stamps)) {
    other = bestOf(allTimes_s(interval, usual_s));
  }
  if (other.ratio > 0.0) return other.T_odom_cog;
  if (!follows && is_doubtful) return std::nullopt;

  intervals_s_.add(dt_s);
  if (by_the_stamps && by_the_stamps->observed && by_the_stamps->moved_m <= kMaxMoved_m) {
    usual_ = *by_the_stamps;
    sweeps_to_usual_ = kUsualEvery;
  }
  return std::nullopt;
}

ClockJumpDetector::Place ClockJumpDetector::placeFrom(const Pose& T_odom_cog, const Fit& fit) {
  const Measurement found = fit(T_odom_cog);
  if (!found.ok()) return Place();
  return {found.inlier_ratio, found.inlier_ratio * found.min_information_ratio, found.degenerate_directions == 0,
          distance_m(found.T_odom_cog, T_odom_cog), found.T_odom_cog};
}

bool ClockJumpDetector::isMisfit(const Place& place) const {
  return usual_.observed && place.ratio < kMisfitRatio * usual_.ratio &&
         place.information < kMisfitInformation * usual_.information;
}

bool ClockJumpDetector::isRight(const Place& place, double reach_m, double clearly_m,
                                const std::optional<Place>& by_the_stamps, const Pose& T_odom_cog_predicted) const {
  if (!usual_.observed || !place.observed || place.moved_m > reach_m) return false;
  const double ratio = place.ratio / usual_.ratio, information = place.information / usual_.information;
  if (!by_the_stamps || by_the_stamps->ratio <= 0.0) {
    if (ratio < kRatio) return false;
    return (ratio + kInformationWeight * std::min(information, 1.0) >= kAlone && information >= kInformationAlone) ||
           (by_the_stamps && information >= kInformationNothingFits);
  }
  if (ratio < kRatio || information < kInformation) return false;
  if (distance_m(place.T_odom_cog, by_the_stamps->T_odom_cog) < kSamePlace_m) {
    return distance_m(place.T_odom_cog, T_odom_cog_predicted) > place.moved_m + clearly_m;
  }
  return place.information >= kClearlyMore * by_the_stamps->information;
}

}  // namespace fail_aware
