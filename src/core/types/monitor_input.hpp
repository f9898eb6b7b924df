// The monitor's input for one sweep of a recorded run: a row of monitor_log.csv (io/monitor_log.hpp). The monitor can
// be run again from these rows (integrity/monitor_replay.hpp).
#pragma once

#include <cstddef>

#include "core/types/filter_state.hpp"
#include "core/types/sweep_condition.hpp"

namespace fail_aware {

/// One call of FailAwareMonitor::update.
struct MonitorInput {
  std::size_t row = 0;  ///< row of the sweep in the run's trajectory, from 0
  FilterState state;
  SweepCondition condition;
};

}  // namespace fail_aware
