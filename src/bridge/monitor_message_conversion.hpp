// The messages of the fail-aware monitor <-> the core's structs (core/integrity/monitor.hpp).
#pragma once

#include "fail_aware_lidar_odometry/FilterState.h"
#include "fail_aware_lidar_odometry/TimeToFailure.h"
#include <std_msgs/Header.h>

#include "core/integrity/monitor.hpp"
#include "core/types/sweep_condition.hpp"
#include "fail_aware_lidar_odometry/monitor.hpp"

namespace fail_aware {

namespace messages = ::fail_aware_lidar_odometry;

/// The monitor's second input, the same as offline: a source that the filter does not use is not listed and not missed.
SweepCondition conditionOf(const messages::FilterState& message);

messages::TimeToFailure toMessage(const MonitorOutput& output, const MonitorParameters& params,
                                  const std_msgs::Header& header);

}  // namespace fail_aware
