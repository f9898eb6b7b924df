// The line through the stamps of a head's turns: its period and phase, by least squares over the last 40 stamps.
//
// The period may be known beforehand, to a standard deviation: it counts as one more measurement. Otherwise the first
// stamps tell it: the median of their intervals says how many turns lie between two of them, anew with each stamp, for
// an early count may be wrong. Residuals that lie on one side of the line say that the head turns at another rate by
// now: the older half of the stamps is forgotten.
// Units: s, turns. Failure: none. Cost: under 1 us a stamp.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>

namespace fail_aware {

class TurnLine {
 public:
  static constexpr double kShortestTurn_s = 0.02;  ///< 50 Hz: no head turns faster,
  static constexpr double kLongestTurn_s = 0.22;   ///< nor slower than 5 Hz: a longer interval holds a gap

  /// Forgets the stamps. `sigma_s`: standard deviation of `period_s`.
  void restart(double period_s, double sigma_s);

  /// The stamp of a turn; turns are counted from any one. `noise_s`: standard deviation of each stamp.
  void add(double turn, double stamp_s, double noise_s);

  bool empty() const { return stamps_.empty(); }
  /// 0: not known, before three intervals that a head can take.
  double period_s() const { return period_s_; }

  /// Standard deviation of the period.
  double periodSigma_s() const { return period_sigma_s_; }

  /// The time of a turn. At least one stamp must be there.
  double at(double turn) const { return mean_s_ + (turn - mean_turn_) * period_s_; }

  /// Standard deviation of a stamp's distance from at(), in the stamp's own.
  double predictionFactor(double turn) const;

 private:
  struct Stamp {
    double turn = 0.0, stamp_s = 0.0;
  };

  std::optional<double> medianInterval_s() const;
  void countTurns(double interval_s);
  void fit(double noise_s);
  double meanResidual_s() const;

  double known_period_s_ = 0.0, known_sigma_s_ = 0.0;  ///< 0: the stamps alone tell it
  std::deque<Stamp> stamps_;
  double period_s_ = 0.0, period_sigma_s_ = 0.0;
  double mean_turn_ = 0.0, mean_s_ = 0.0;
  double period_factor_ = 0.0;  ///< period_sigma_s_ in the stamps' noise
};

}  // namespace fail_aware
