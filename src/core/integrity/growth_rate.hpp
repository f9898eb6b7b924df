// How the accumulated covariance grows if the last sweeps go on: averages for the prediction
// (covariance_predictor.hpp).
//
// Of the increments the mean over a window in time, of the speed's error (dead_reckoning.hpp) medians over 5 sweeps. A
// single blinded sweep says nothing of the future: sweeps whose error a registration may take back count from 0.3 s on,
// and no longer once one has.
// The speed's error wanders: measurements take a part of it back in each sweep, and as much is made anew. In a tunnel
// it is 0.4 m/s, and of another sign every 0.6 s.
// On a weak stretch ahead (road_ahead.hpp) the growth is assumed to be that of a simulated tunnel.
// Cost: five medians of a few values a sweep.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>

#include "core/estimation/odometry_covariance.hpp"
#include "core/integrity/covariance_growth.hpp"
#include "core/integrity/road_ahead.hpp"
#include "core/moving_median.hpp"
#include "core/types/information_ahead.hpp"

namespace fail_aware {

/// The increments' covariance per second, averaged over the last `window_s` of accepted increments.
class IncrementRate {
 public:
  explicit IncrementRate(double window_s) : window_s_(window_s) {}

  /// `increment_covariance`: of one sweep's motion, about the previous body's axes. False: ignored (not a covariance,
  /// or dt not > 0). `open`: DriftRate::open.
  bool update(const Matrix6d& increment_covariance, double dt_s, bool open);
  /// (x, y, yaw) about the body's axes: m^2/s, m rad/s, rad^2/s. Nothing before the first increment.
  std::optional<Eigen::Matrix3d> rate() const;
  /// The newest increments are open, and too few to count.
  bool isBrieflyOpen() const { return !increments_.empty() && increments_.back().open && !isBlinded(); }
  double window_s() const { return window_s_; }
  void reset() { increments_.clear(); }

 private:
  struct Increment {
    Eigen::Matrix3d covariance;
    double dt_s;
    bool open;
  };
  bool isBlinded() const;
  double window_s_;
  std::deque<Increment> increments_;
};

class GrowthRate {
 public:
  explicit GrowthRate(double window_s) : increments_(window_s) {}

  struct SpeedChange {
    double variance_before = 0.0, variance_now = 0.0;  ///< m^2/s^2
    double kept = 0.0;                                 ///< SpeedError::kept
  };
  void add(const DriftRate& rate, const SpeedChange& speed, double dt_s);
  bool known() const { return increments_.rate().has_value(); }
  /// The error of the last sweeps does not count yet.
  bool isBrieflyOpen() const { return increments_.isBrieflyOpen(); }
  /// What the sweep sees of the road ahead.
  void lookAhead(const InformationAhead& ahead) { road_ahead_.add(ahead); }
  const RoadAhead& roadAhead() const { return road_ahead_; }

  /// Sets the rates (zeros before the first sweep) and the weak stretch, if there is one.
  void describe(double min_information_ratio, CovarianceGrowth& growth) const;
  void reset() { *this = GrowthRate(increments_.window_s()); }

 private:
  static constexpr std::size_t kSweeps = 5;
  IncrementRate increments_;
  MovingMedian speed_share_{kSweeps};      ///< DriftRate::speed_share
  MovingMedian speed_noise_{kSweeps};      ///< m^2/s^3
  MovingMedian speed_forgotten_{kSweeps};  ///< 1/s
  RoadAhead road_ahead_;
  MovingMedian weak_rate_{kSweeps}, weak_share_{kSweeps};  ///< of CovarianceGrowth::WeakStretch
};

}  // namespace fail_aware
