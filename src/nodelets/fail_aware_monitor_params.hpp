// FailAwareMonitor's own parameters: those of its private namespace.
#pragma once

#include "fail_aware_lidar_odometry/core/parameters/check.hpp"

namespace fail_aware {

struct FailAwareMonitorNodeletParams {
  bool start_redundant = true;  ///< t1 is the first sweep, also after a reset; false: the service says when
  double stale_sweeps = 3.0;    ///< sweep periods without a filter state that mean failure
  double min_period_s = 0.05;   ///< the measured sweep period is taken to be within these
  double max_period_s = 0.15;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("start_redundant", self.start_redundant);
    v("stale_sweeps", self.stale_sweeps);
    v("min_period_s", self.min_period_s);
    v("max_period_s", self.max_period_s);
  }
  void validate() const {
    requirePositive("stale_sweeps", stale_sweeps);
    requirePositive("min_period_s", min_period_s);
    requireParameter(max_period_s >= min_period_s, "max_period_s", max_period_s, "at least min_period_s");
  }
};

}  // namespace fail_aware
