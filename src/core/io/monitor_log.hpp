// monitor_log.csv: all that the fail-aware monitor hears in a run, so that it can be run again for any start (t1) and
// any parameters without running the odometry (integrity/monitor_replay.hpp).
//
// One row a monitored sweep, one column a number of MonitorInput (io/number_table.hpp); lists have one entry a measurement
// source. Poses are the upper 3x4 of the matrix, row by row; units m, s, rad.
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
