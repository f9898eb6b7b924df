// The line through the stamps of a head's revolutions: period and phase, by least squares over the last 40 stamps.
//
// The period may be known beforehand, with a standard deviation: it counts as one more measurement. Otherwise the first
// stamps give it: the median of their intervals gives the number of revolutions between two stamps. The numbers are
// recomputed with each stamp, because an early number may be wrong. Residuals on one side of the line mean that the
// spin rate has changed: the older half of the stamps is dropped.
// Units: s, revolutions ("turns").
// Failure: none. Cost: under 1 us per stamp.
#pragma once

#include <deque>
#include <optional>

#include "core/stamp_difference.hpp"

namespace fail_aware {

class TurnLine {
 public:
  static constexpr double kShortestTurn_s = kShortestPeriod_s;
  static constexpr double kLongestTurn_s = 0.22;  ///< heads rotate at 5 Hz or faster: a longer interval holds a gap

  /// Forgets the stamps. `sigma_s`: standard deviation of `period_s`.
  void restart(double period_s, double sigma_s);

  /// Adds the stamp of a revolution; their count may start anywhere. `noise_s`: standard deviation of each stamp.
  void add(double turn, double stamp_s, double noise_s);

  bool empty() const { return stamps_.empty(); }
  /// 0: not known, before three intervals that are plausible for a head.
  double period_s() const { return period_s_; }

  /// Standard deviation of the period.
  double periodSigma_s() const { return period_sigma_s_; }

  /// The time of a revolution. Needs at least one stamp.
  double at(double turn) const { return mean_s_ + (turn - mean_turn_) * period_s_; }

  /// Standard deviation of a stamp's distance from at(), divided by the stamp's own.
  double predictionFactor(double turn) const;

 private:
  struct Stamp {
    double turn = 0.0, stamp_s = 0.0;
  };

  std::optional<double> medianInterval_s() const;
  void countTurns(double interval_s);
  void fit(double noise_s);
  double meanResidual_s() const;

  double known_period_s_ = 0.0, known_sigma_s_ = 0.0;  ///< 0: from the stamps alone
  std::deque<Stamp> stamps_;
  double period_s_ = 0.0, period_sigma_s_ = 0.0;
  double mean_turn_ = 0.0, mean_s_ = 0.0;
  double period_factor_ = 0.0;  ///< period_sigma_s_ divided by the stamps' noise
};

}  // namespace fail_aware
