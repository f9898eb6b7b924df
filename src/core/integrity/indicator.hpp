// The fail-aware indicator eta and its time to failure (paper, section "Fail-Aware Odometry System", equation of eta).
//
// Article: eta = sum from t1 on of |d2 sigma_psi / dt2|; failure at eta = 0.001. It gives neither the unit nor the
// discrete formula. Here, for samples (t_k, s_k), s = the filter's heading standard deviation in rad:
//   slope_k = (s_k - s_k-1) / (t_k - t_k-1)                               rad/s, any spacing of the stamps
//   eta    += reference_period_s * |slope_k - slope_k-1|                  rad
// That is sum |s''_k| dt_k T: s'' the divided second difference, dt_k = (t_k - t_k-2) / 2, T = reference_period_s. At
// sweeps T apart it is sum |s_k - 2 s_k-1 + s_k-2|: the article's sum with time counted in sweeps, the scale on which
// 0.001 is a sensible number at 10 Hz. Dependence on the sampling: for a smooth sigma none (total variation of its
// slope); for noise in sigma, eta's growth per second goes with the sweep rate squared. So a threshold belongs to one
// sweep rate.
//
// Sweep by sweep the sum is made of the jitter of s, whatever the road; and a heading error becomes a position error by
// the distance driven. So, beyond the article, (t_k, s_k) may be means over average_s, and each term is then weighted
// with v_k / reference_speed_mps, the mean speed of that time. 0 of either: the article's sum (profile paper). While
// the sensor is gone sigma leaps and comes back, which says nothing of the road: such sweeps are left out
// (measured_only).
//
// eta_rate = (eta_k - eta_k-n) / (t_k - t_k-n), n = rate_window_samples (article: 1); time to failure =
// (threshold - eta) / eta_rate. Three samples after t1 are needed; before: unknown. eta >= threshold: reached.
// eta_rate = 0: beyond the horizon.
// Failure: a sample is ignored if it comes before t1 or start(), if it is not min_interval_s after the last one (after
// a jump back in time, call start() again), or if a value is not finite, negative (sigma) or absurd (sigma > 1e6 rad).
// After more than max_gap_s a sample counts as the first: eta is kept, the rate is unknown. eta never falls and is
// never NaN.
// Cost: O(1).
#pragma once

#include <deque>
#include <optional>

#include "core/parameters/check.hpp"
#include "fail_aware_lidar_odometry/monitor.hpp"

namespace fail_aware {

class FailAwareIndicator {
 public:
  struct Params {
    double threshold = 0.001;  ///< rad, on the scale above
    int rate_window_samples = 10;
    double horizon_s = 60.0;
    /// sweep period that the threshold belongs to: T above; the article's 10 Hz
    double reference_period_s = 0.1;
    /// a sample closer to its predecessor is left out: a slope over less is noise
    double min_interval_s = 0.01;
    double max_gap_s = 1.0;             ///< longer without a sample: the rate is unknown, eta is kept
    double average_s = 1.0;             ///< 0: a sample is a sweep
    double reference_speed_mps = 10.0;  ///< 0: not weighted with the speed
    bool measured_only = true;          ///< sweeps whose pose is a prediction count as missing

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("threshold", self.threshold, requirePositive);
      v("rate_window_samples", self.rate_window_samples, within(1, 100000));
      v("horizon_s", self.horizon_s, requirePositive);
      v("average_s", self.average_s, within(0.0, 1e3));
      v("reference_speed_mps", self.reference_speed_mps, within(0.0, 1e3));
      v("measured_only", self.measured_only);
    }
  };

  explicit FailAwareIndicator(const Params& params) : params_(params) {}

  /// Sets t1 and clears everything. A stamp that is not finite leaves the indicator not started.
  void start(double stamp_s);
  void stop() { *this = FailAwareIndicator(params_); }
  bool started() const { return start_stamp_s_.has_value(); }

  void update(double stamp_s, double sigma_yaw_rad, double speed_mps);

  double eta() const { return eta_; }     ///< rad; 0 until three samples came
  std::optional<double> etaRate() const;  ///< rad/s, >= 0; nothing: unknown
  TimeToFailure timeToFailure() const;

 private:
  struct EtaAt {
    double stamp_s;
    double eta;
  };

  struct Sample {
    double stamp_s = 0.0, sigma_rad = 0.0, speed_mps = 0.0;
  };
  void add(const Sample& sample);

  Params params_;
  std::optional<double> start_stamp_s_;
  std::optional<double> last_stamp_s_;
  Sample sum_;  ///< of the sweeps since average_from_s_, stamps counted from there
  int summed_ = 0;
  double average_from_s_ = 0.0;
  std::optional<Sample> last_;
  std::optional<double> last_slope_;
  double eta_ = 0.0;
  std::deque<EtaAt> window_;  ///< at most rate_window_samples + 1; starts where the first slope is known
};

}  // namespace fail_aware
