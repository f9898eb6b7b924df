// The true times of the sweeps, from stamps that jitter.
//
// A head turns steadily (an HDL-64E on a vehicle: to 0.03 ms from turn to turn), a host stamps its clouds to some
// milliseconds. So the clock holds a model of the head, phase and period: the line through the last stamps
// (turn_line.hpp), whose noise is the jitter found in them. Sweep times only matter by their differences: they give the
// interval that the prediction bridges and the speeds of the motion history.
//
// - Jitter: from the second differences of the stamps (median, so that single wrong stamps do not count). Up to 0.5 ms
//   it does not matter, and times are the stamps, bit for bit.
// - A single wrong stamp lies off the model by more than the tolerance. It is left out: the model gives the time.
// - A clock that was set: three such stamps in a row with one offset. The offset is taken over.
// - A spin rate that changed: three such stamps in a row on a line of another period, or points' times that say so.
// - Dropped sweeps: the interval is a whole number of periods. After three or more, with another phase, the head or its
//   driver began anew, and the stamp is believed.
// Until three intervals or the points' times tell the period, the stamps are believed.
//
// Units: s. Failure: none; a stamp that is not after the last one gets an interval that is not positive where no period
// is known. Cost: under 1 us a sweep.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "fail_aware_lidar_odometry/core/moving_median.hpp"
#include "fail_aware_lidar_odometry/core/sweep/turn_line.hpp"
#include "fail_aware_lidar_odometry/core/types/sweep_time.hpp"

namespace fail_aware {

/// The jitter of stamps that should be a period apart: of the last 40, or of the last 10 where that is more.
class StampJitter {
 public:
  /// Between two stamps of consecutive turns.
  void add(double interval_s);
  /// The next interval does not follow on the last one.
  void interrupt() { last_interval_s_.reset(); }
  void clear();

  /// Standard deviation of one stamp; none: not known yet.
  std::optional<double> sigma_s() const;

 private:
  std::optional<double> last_interval_s_;
  MovingMedian second_differences_s_{41}, newest_differences_s_{11};  ///< without their signs
  double largest_difference_s_ = 0.0;
};

class SweepClock {
 public:
  /// `given_period_s`: the head's, where it is known; 0: found from stamps and points' times.
  explicit SweepClock(double given_period_s = 0.0);

  /// The next sweep that is taken. Times advance where the period is known. `set_back_s`: a stamp was refused since the
  /// last sweep that was so much older than it (StampSequence); 0: none was.
  SweepTime next(double stamp_s, double set_back_s = 0.0);

  /// The time of one turn as the last sweep's point times tell it; 0: they do not. A cloud may hold a part of a turn, or
  /// several: the stamps tell how many.
  void observeRevolution(double revolution_s);

  /// Of the stamps, standard deviation; none: not known yet.
  std::optional<double> jitter_s() const { return jitter_.sigma_s(); }

  /// Of the head, as stamps tell it; none: not known yet.
  std::optional<double> period_s() const;

  /// Stamps that were left out because the model contradicts them.
  std::size_t outliers() const { return outliers_; }

  void reset() { *this = SweepClock(given_period_s_); }

 private:
  struct Interval {
    double seconds = 0.0;
    double sigma_s = 0.0;
  };
  struct Deviation {  ///< of a stamp from the model
    double seconds = 0.0;
    double turns = 1.0;  ///< since the sweep before
  };

  bool wasSetBack(double since_s, double set_back_s) const;
  Interval interval(double since_s, double stamps_apart_s);
  void followRevolution(double revolution_s);
  void setPeriod(double period_s, double sigma_s);
  double turnsIn(double since_s) const;
  bool hasPeriod() const { return line_.period_s() > 0.0; }
  double noise_s() const;
  double tolerance_s(double turns = 1.0) const;
  bool isTrusted(double deviation_s) const;
  Interval advance(double turns, std::optional<double> trusted_s);
  Interval withoutStamp(const Deviation& deviation);
  bool followsAnotherLine();

  double given_period_s_;
  std::optional<double> last_stamp_s_;
  double last_error_s_ = 0.0;
  double offset_s_ = 0.0;             ///< of the stamps' clock, since it was set
  TurnLine line_;                     ///< its period is 0 as long as none is known
  double turn_ = 0.0, time_s_ = 0.0;  ///< of the last sweep, on the line
  double set_at_turn_ = -1e9;         ///< the clock was set
  bool period_sure_ = false;          ///< given, or told by the points' times
  StampJitter jitter_;
  std::vector<Deviation> deviations_;  ///< of the last stamps, if they were left out
  double turns_per_cloud_ = 0.0;       ///< 0: not known
  double new_revolution_s_ = 0.0;      ///< the last sweep's, if the period does not follow it yet
  std::size_t intervals_ = 0, outliers_ = 0;
};

}  // namespace fail_aware
