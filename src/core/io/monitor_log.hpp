// monitor_log.csv: the complete input of the fail-aware monitor in a run. The monitor can be replayed from it for any
// start (t1) and any parameters without running the odometry (integrity/monitor_replay.hpp).
//
// One row per monitored sweep, one column per number of MonitorInput (io/number_table.hpp); lists have one entry per
// measurement source. Poses are the upper 3x4 of the matrix, row by row; units m, s, rad.
// Failure: readMonitorLog throws InputError naming file and line.
#pragma once

#include <string>
#include <vector>

#include "core/types/monitor_input.hpp"

namespace fail_aware {

/// Without the line break.
std::string monitorLogHeader();
std::string monitorLogRow(const MonitorInput& input);

std::vector<MonitorInput> readMonitorLog(const std::string& path);

}  // namespace fail_aware
