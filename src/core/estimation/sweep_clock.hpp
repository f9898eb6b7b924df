// The true times of the sweeps, from stamps with jitter. Not in the paper.
//
// A head rotates steadily (an HDL-64E on a vehicle: to 0.03 ms per revolution); a host stamps its clouds to some
// milliseconds. The clock therefore models the head by phase and period: the line through the last stamps
// (turn_line.hpp), whose noise is the measured jitter. Only differences of sweep times matter: they set the interval of
// the prediction and the speeds of the motion history.
//
// - Jitter: from the second differences of the stamps (median, so that single wrong stamps do not count). Up to 0.5 ms
//   it does not matter, and times are the stamps, bit for bit.
// - A single wrong stamp differs from the model by more than the tolerance. It is left out: the model gives the time.
// - A clock that was set: three such stamps in a row with one offset. The offset is adopted.
// - A changed spin rate: three such stamps in a row on a line of another period, or points' times with another period.
// - Dropped sweeps: the interval is a whole number of periods. After three or more, with another phase, the head or its
//   driver has restarted, and the stamp is believed. With jitter a stamp may be late instead: the likelier counts, and
//   the interval's standard deviation holds the other.
// Until three intervals, or the points' times and an interval of a whole revolution, give the period, the stamps are
// believed: a driver's first cloud may be a part of a revolution.
//
// Units: s.
// Failure: none; a stamp that is not after the last one gets an interval that is not positive while no period is known.
// Cost: under 1 us per sweep.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/estimation/turn_line.hpp"
#include "core/moving_median.hpp"
#include "core/types/sweep_time.hpp"

namespace fail_aware {

/// The jitter of stamps that should be one period apart: of the last 40, or of the last 10 if that is larger.
class StampJitter {
 public:
  /// The interval between two stamps of consecutive revolutions.
  void add(double interval_s);
  /// The next interval does not follow the last one.
  void interrupt() { last_interval_s_.reset(); }

  /// Standard deviation of one stamp; nullopt: not known yet.
  std::optional<double> sigma_s() const;

 private:
  std::optional<double> last_interval_s_;
  MovingMedian second_differences_s_{41}, newest_differences_s_{11};  ///< absolute values
  double largest_difference_s_ = 0.0;
};

class SweepClock {
 public:
  /// `given_period_s`: of the head, if known; 0: estimated from stamps and points' times.
  explicit SweepClock(double given_period_s = 0.0);

  /// The time of the next accepted sweep. Times advance while the period is known. `set_back_s`: a stamp was refused
  /// since the last sweep because it was this much older (StampSequence); 0: none.
  SweepTime next(double stamp_s, double set_back_s = 0.0);

  /// The time of one revolution from the last sweep's point times; 0: unknown. A cloud may hold a part of a revolution,
  /// or several: the stamps show how many.
  void observeRevolution(double revolution_s);

  /// Standard deviation of the stamps; nullopt: not known yet.
  std::optional<double> jitter_s() const { return jitter_.sigma_s(); }

  /// Period of the head from the stamps; nullopt: not known yet.
  std::optional<double> period_s() const;

  /// Number of stamps that were left out because they contradict the model.
  std::size_t outliers() const { return outliers_; }

  void reset() { *this = SweepClock(given_period_s_); }

 private:
  struct Interval {
    double seconds = 0.0;
    double sigma_s = 0.0;
  };
  struct Deviation {  ///< of a stamp from the model
    double seconds = 0.0;
    double turns = 1.0;  ///< since the previous sweep
  };

  struct LastSweep {
    std::optional<double> stamp_s{};
    double error_s = 0.0;
    double turn = 0.0, time_s = 0.0;  ///< on the line
  };

  bool lastExplains(double set_back_s) const;
  bool wasSetBack(double since_s, double set_back_s) const;
  /// The stamps do not count this time if the refused stamp came one revolution after the last sweep.
  double uncounted_s(double set_back_s) const { return set_back_s > 0.0 ? set_back_s + line_.period_s() : 0.0; }
  Interval interval(double since_s, double stamps_apart_s);
  void followRevolution(double revolution_s);
  void setPeriod(double period_s, double sigma_s);
  double turnsIn(double since_s) const;
  bool hasPeriod() const { return line_.period_s() > 0.0; }
  double noise_s() const;
  double tolerance_s(double turns = 1.0) const;
  bool isTrusted(double deviation_s) const;
  double fewerTurnsSigma_s(double turns, double deviation_s) const;
  Interval advance(double turns, std::optional<double> trusted_s);
  Interval withoutStamp(const Deviation& deviation);
  bool followsAnotherLine();

  double given_period_s_;
  LastSweep last_;
  double last_apart_s_ = 0.0;  ///< the last two stamps
  double offset_s_ = 0.0;      ///< of the stamps' clock, since the clock was set
  TurnLine line_;              ///< its period is 0 while none is known
  double set_at_turn_ = -1e9;  ///< when the clock was set
  bool period_sure_ = false;   ///< given, or known from the points' times
  StampJitter jitter_;
  std::vector<Deviation> deviations_;  ///< of the last stamps, if they were left out
  double turns_per_cloud_ = 0.0;       ///< 0: not known
  double new_revolution_s_ = 0.0;      ///< of the last sweep, if the period does not follow it yet
  std::size_t intervals_ = 0, outliers_ = 0;
};

}  // namespace fail_aware
