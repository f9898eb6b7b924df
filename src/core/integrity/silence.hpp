// Silence is a failure (not in the paper): when no filter state comes for some sweep periods, the monitor says so by
// itself.
//
// Live, a timer asks; offline, the evaluation looks at the time from one sweep to the next. No failure modes.
#pragma once

#include "core/parameters/check.hpp"
#include "core/stamp_difference.hpp"
#include "fail_aware_lidar_odometry/monitor.hpp"

namespace fail_aware {

struct SilenceParams {
  double stale_sweeps = 3.0;  ///< sweep periods without a filter state that mean failure
  double min_period_s = 0.1;  ///< the measured sweep period is taken to be within these
  double max_period_s = 0.15;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("stale_sweeps", self.stale_sweeps, within(1.0, 20.0));
    v("min_period_s", self.min_period_s, within(0.001, kLongestPeriod_s));
    v("max_period_s", self.max_period_s);
  }
  void checkRules() const;
};

/// `period_s`: between the last two filter states.
double staleAfter_s(const SilenceParams& params, double period_s);

/// The output from then on, until the next filter state: FAILED, and the time to failure is 0. The two times that it is
/// made of and the protection level are unknown, because nothing computes them. Eta and the sigmas stay those of
/// `last`, the output of the last filter state.
MonitorOutput staleOutput(MonitorOutput last);

}  // namespace fail_aware
