#include "fail_aware_lidar_odometry/core/registration/interval_check.hpp"

#include <algorithm>

#include "fail_aware_lidar_odometry/core/geometry/rotation.hpp"

namespace fail_aware {

namespace {

constexpr double kUnusual = 1.5;  // times longer than the usual interval, or shorter: may be wrong
constexpr int kUsualEvery = 10;   // sweeps
// Of what usually fits there must be at least: where there is another place to compare with; more of the information
// where nothing fits there; and of both where none was found.
constexpr double kShare = 0.7, kInformation = 0.4;
constexpr double kShareAlone = 0.9, kInformationAlone = 0.7;
constexpr double kClearlyMore = 1.5;  // times the information at the place that the stamps ask for
constexpr double kSamePlace_m = 0.2;
constexpr double kMaxMoved_m = 0.3;       // from the way of the right interval to where the sweep fits,
constexpr double kDriver_mps2 = 3.0;      // and what the driver may have done meanwhile,
constexpr double kMaxMovedAtAll_m = 1.0;  // but no farther

double distance_m(const Pose& a, const Pose& b) { return (a.translation() - b.translation()).norm(); }

}  // namespace

std::optional<Pose> IntervalCheck::findOther(const Interval& interval, const Fit& fit) {
  if (!(interval.dt_s > 0.0)) return std::nullopt;
  const double usual_s = intervals_s_.size() > 0 ? intervals_s_.median() : interval.dt_s;
  const bool is_unusual = interval.dt_s > kUnusual * usual_s || kUnusual * interval.dt_s < usual_s;
  const bool set_back = interval.set_back_s > 0.0;

  std::optional<Place> by_the_stamps;
  if (interval.T_odom_cog_by_the_stamps && (is_unusual || set_back || --sweeps_to_usual_ <= 0)) {
    by_the_stamps = placeFrom(*interval.T_odom_cog_by_the_stamps, fit);
  }
  Place other;
  const auto consider = [&](double dt_s) {
    const Place place = placeFrom(interval.T_odom_cog_previous * expSe3(interval.twist_cog * dt_s), fit);
    if (place.information <= other.information) return;
    if (isRight(place, dt_s, by_the_stamps, interval.T_odom_cog_predicted)) other = place;
  };
  if (is_unusual) consider(usual_s);
  // the stamp that was refused came a usual interval after the last one
  if (set_back) consider(interval.dt_s + usual_s + interval.set_back_s);
  if (other.share > 0.0) return other.T_odom_cog;

  intervals_s_.add(interval.dt_s);
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

bool IntervalCheck::isRight(const Place& place, double dt_s, const std::optional<Place>& by_the_stamps,
                            const Pose& T_odom_cog_predicted) const {
  const double reach_m = std::min(kMaxMoved_m + 0.5 * kDriver_mps2 * dt_s * dt_s, kMaxMovedAtAll_m);
  if (!usual_.observed || !place.observed || place.moved_m > reach_m) return false;
  const auto isAsUsual = [&](double share, double information) {
    return place.share >= share * usual_.share && place.information >= information * usual_.information;
  };
  if (!by_the_stamps) return isAsUsual(kShareAlone, kInformationAlone);
  if (by_the_stamps->share <= 0.0) return isAsUsual(kShare, kInformationAlone);
  if (!isAsUsual(kShare, kInformation)) return false;
  if (distance_m(place.T_odom_cog, by_the_stamps->T_odom_cog) < kSamePlace_m) {
    return distance_m(place.T_odom_cog, T_odom_cog_predicted) > place.moved_m + kMaxMoved_m;
  }
  return place.information >= kClearlyMore * by_the_stamps->information;
}

}  // namespace fail_aware
