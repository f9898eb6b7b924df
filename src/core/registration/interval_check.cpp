#include "fail_aware_lidar_odometry/core/registration/interval_check.hpp"

#include <algorithm>

#include "fail_aware_lidar_odometry/core/geometry/rotation.hpp"

namespace fail_aware {

namespace {

constexpr double kUnusual = 1.5;  // times longer than the usual interval, or shorter: may be wrong
constexpr int kUsualEvery = 10;   // sweeps
// Of what usually fits there must be at least: where there is another place to compare with; more of the information
// where nothing fits there; and where none was found. In simulated drives the right place has 0.87 of the share and 0.39
// of the information or more; a wrong one that registration finds 0.82 and 0.25, or 0.76 and 0.43, at most.
constexpr double kShare = 0.7, kInformation = 0.4;
constexpr double kInformationNothingFits = 0.7;
constexpr double kShareAlone = 0.85, kInformationAlone = 0.35;
constexpr double kClearlyMore = 1.5;  // times the information at the place that the stamps ask for
constexpr double kSamePlace_m = 0.2;
constexpr double kMaxMoved_m = 0.3;       // from the way of the right interval to where the sweep fits,
constexpr double kDriver_mps2 = 3.0;      // and what the driver may have done meanwhile,
constexpr double kMaxMovedAtAll_m = 1.0;  // but no farther

double distance_m(const Pose& a, const Pose& b) { return (a.translation() - b.translation()).norm(); }

}  // namespace

// The intervals since the last measured sweep, and what was driven in them if other than by the stamps.
IntervalCheck::Driven IntervalCheck::drivenIn(const Interval& interval, double usual_s) {
  Driven driven;
  const auto add = [&](const Stamps& stamps) {
    const bool is_unusual = stamps.dt_s > kUnusual * usual_s || kUnusual * stamps.dt_s < usual_s;
    driven.is_unusual = driven.is_unusual || is_unusual;
    driven.if_usual_s += is_unusual ? usual_s : stamps.dt_s;
    const bool is_set_back = stamps.set_back_s > 0.0;
    driven.is_set_back = driven.is_set_back || is_set_back;
    // the stamp that was refused came a usual interval after the last one
    driven.if_set_back_s += stamps.dt_s + (is_set_back ? usual_s + stamps.set_back_s : 0.0);
  };
  for (const Stamps& stamps : interval.unmeasured) add(stamps);
  add(interval.stamps);
  return driven;
}

std::optional<Pose> IntervalCheck::findOther(const Interval& interval, const Fit& fit) {
  const double dt_s = interval.stamps.dt_s;
  if (!(dt_s > 0.0)) return std::nullopt;
  const Driven driven = drivenIn(interval, intervals_s_.size() > 0 ? intervals_s_.median() : dt_s);
  const bool is_doubtful = driven.is_unusual || driven.is_set_back, follows = interval.unmeasured.empty();
  if (!follows && !is_doubtful) return std::nullopt;

  std::optional<Place> by_the_stamps;
  if (interval.T_odom_cog_by_the_stamps && (is_doubtful || --sweeps_to_usual_ <= 0)) {
    by_the_stamps = placeFrom(*interval.T_odom_cog_by_the_stamps, fit);
  }
  Place other;
  const auto consider = [&](double driven_s) {
    const Place place = placeFrom(interval.T_odom_cog_previous * expSe3(interval.twist_cog * driven_s), fit);
    if (place.information <= other.information) return;
    if (isRight(place, driven_s, by_the_stamps, interval.T_odom_cog_predicted)) other = place;
  };
  if (driven.is_unusual) consider(driven.if_usual_s);
  if (driven.is_set_back) consider(driven.if_set_back_s);
  if (other.share > 0.0) return other.T_odom_cog;
  if (!follows) return std::nullopt;

  intervals_s_.add(dt_s);
  if (by_the_stamps && by_the_stamps->observed && by_the_stamps->moved_m <= kMaxMoved_m) {
    usual_ = *by_the_stamps;
    sweeps_to_usual_ = kUsualEvery;
  }
  return std::nullopt;
}

IntervalCheck::Place IntervalCheck::placeFrom(const Pose& T_odom_cog, const Fit& fit) {
  const Measurement found = fit(T_odom_cog);
  if (!found.ok()) return Place();
  return {found.inlier_share, found.inlier_share * found.min_information_share, found.weak_directions == 0,
          distance_m(found.T_odom_cog, T_odom_cog), found.T_odom_cog};
}

bool IntervalCheck::isRight(const Place& place, double driven_s, const std::optional<Place>& by_the_stamps,
                            const Pose& T_odom_cog_predicted) const {
  const double reach_m = std::min(kMaxMoved_m + 0.5 * kDriver_mps2 * driven_s * driven_s, kMaxMovedAtAll_m);
  if (!usual_.observed || !place.observed || place.moved_m > reach_m) return false;
  const auto isAsUsual = [&](double share, double information) {
    return place.share >= share * usual_.share && place.information >= information * usual_.information;
  };
  if (!by_the_stamps || by_the_stamps->share <= 0.0) {
    return isAsUsual(kShareAlone, kInformationAlone) || (by_the_stamps && isAsUsual(kShare, kInformationNothingFits));
  }
  if (!isAsUsual(kShare, kInformation)) return false;
  if (distance_m(place.T_odom_cog, by_the_stamps->T_odom_cog) < kSamePlace_m) {
    return distance_m(place.T_odom_cog, T_odom_cog_predicted) > place.moved_m + kMaxMoved_m;
  }
  return place.information >= kClearlyMore * by_the_stamps->information;
}

}  // namespace fail_aware
