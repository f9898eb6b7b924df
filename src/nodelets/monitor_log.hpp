// The monitor's lines in the log: when t1 is set, moves or ends, and when the state becomes FAILING or FAILED, or is
// neither any more. One line for each change. Call it for every output, from one thread.
#pragma once

#include <ros/console.h>

#include <string>

#include "fail_aware_lidar_odometry/monitor.hpp"

namespace fail_aware {

class MonitorLog {
 public:
  /// `start_redundant`: the parameter; true: t1 comes again by itself.
  explicit MonitorLog(bool start_redundant) : start_redundant_(start_redundant) {}

  void tell(const MonitorOutput& output) {
    tellT1(output.t1_stamp_s);
    tellState(output);
  }

 private:
  void tellT1(double t1_stamp_s) {
    if (t1_stamp_s == t1_stamp_s_) return;
    t1_stamp_s_ = t1_stamp_s;
    if (t1_stamp_s < 0.0) {
      ROS_INFO("fail_aware_monitor: t1 has ended: the state is UNKNOWN until %s",
               start_redundant_ ? "a motion is observed again, which sets t1 anew" : "start_redundant is called");
    } else {
      ROS_INFO("fail_aware_monitor: t1 is %.6f: the state tells of the error since then", t1_stamp_s);
    }
  }

  void tellState(const MonitorOutput& output) {
    const bool was_alarm = isAlarm(state_), is_alarm = isAlarm(output.state);
    if (is_alarm && output.state != state_) {
      const std::string reasons = reasonText(output.reasons);
      ROS_WARN("fail_aware_monitor: the state is %s, time to failure %.1f s%s%s", toString(output.state),
               output.time_to_failure.seconds, reasons.empty() ? "" : ": ", reasons.c_str());
    } else if (was_alarm && !is_alarm) {
      ROS_INFO("fail_aware_monitor: the state is %s", toString(output.state));
    }
    state_ = output.state;
  }

  static bool isAlarm(FailAwareState state) {
    return state == FailAwareState::kFailing || state == FailAwareState::kFailed;
  }

  bool start_redundant_;
  double t1_stamp_s_ = -1.0;
  FailAwareState state_ = FailAwareState::kUnknown;
};

}  // namespace fail_aware
