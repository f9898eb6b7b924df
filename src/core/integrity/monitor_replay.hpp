// Runs the monitor once more over a recorded run, as if the odometry had begun to serve (t1) at another time.
//
// The odometry does not depend on t1, so this equals `offline_odometry --redundant-at S` bit for bit.
// Cost: the monitor's, < 0.1 ms a sweep after t1.
#pragma once

#include <vector>

#include "core/integrity/monitor.hpp"
#include "core/stamp_difference.hpp"
#include "core/types/monitor_input.hpp"
#include "fail_aware_lidar_odometry/monitor.hpp"

namespace fail_aware {

/// t1 is that many s after the first sweep, or up to this much less: stamps are seldom round.
constexpr double kStartTolerance_s = kStampTolerance_s;

/// One output an input, in order. t1: the first sweep at or after `start_s` from the first sweep of `log`. An input
/// with dt_s = 0 after the first is a reset of the filter, and so of the monitor.
std::vector<MonitorOutput> replayMonitor(const std::vector<MonitorInput>& log, double start_s,
                                         const MonitorParameters& params);

}  // namespace fail_aware
