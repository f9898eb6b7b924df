// How the accumulated covariance grows if the last sweeps go on: averages for the prediction (covariance_predictor.hpp).
//
// Of the increments the mean over a window in time. Of the speed's error (dead_reckoning.hpp) medians over 5 sweeps: a
// single blinded sweep says nothing of the future.
// The speed's error wanders: measurements take a part of it back in each sweep, and as much is made anew. In a tunnel it
// is 0.4 m/s, and of another sign every 0.6 s.
// Cost: about 1 us a sweep.
#pragma once

#include "core/estimation/odometry_covariance.hpp"
#include "core/integrity/covariance_predictor.hpp"
#include "core/moving_median.hpp"

namespace fail_aware {

class GrowthRate {
 public:
  /// Throws ParameterError unless window_s > 0.
  explicit GrowthRate(double window_s) : increments_(window_s) {}

  struct SpeedChange {
    double variance_before = 0.0, variance_now = 0.0;  ///< m^2/s^2
    double kept = 0.0;                                 ///< SpeedError::kept
  };
  void add(const DriftRate& rate, const SpeedChange& speed, double dt_s);
  bool known() const { return increments_.rate().has_value(); }
  /// Sets the rates; zeros before the first sweep.
  void describe(CovarianceGrowth& growth) const;
  void reset();

 private:
  static constexpr std::size_t kSweeps = 5;
  IncrementRate increments_;
  MovingMedian speed_share_{kSweeps};      ///< DriftRate::speed_share
  MovingMedian speed_noise_{kSweeps};      ///< m^2/s^3
  MovingMedian speed_forgotten_{kSweeps};  ///< 1/s
};

}  // namespace fail_aware
