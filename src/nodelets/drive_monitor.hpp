// The fail-aware monitor (core/integrity/monitor.hpp) over several drives. A new drive restarts the monitor: a user of
// the last drive's odometry must request start_redundant again. A request that still waits for an observed motion stays
// valid where odom goes on from the last pose or from a pose that was set (after a jump of the stamps, not after a
// reset), and so does one that arrived after the last filter state. With the parameter start_redundant the odometry
// always serves as the localisation, and no request is needed.
// Failure and cost: those of FailAwareMonitor.
#pragma once

#include "core/integrity/monitor.hpp"

namespace fail_aware {

class DriveMonitor {
 public:
  DriveMonitor(const MonitorParameters& params, bool always_serves)
      : params_(params), always_serves_(always_serves), monitor_(params) {
    if (always_serves_) monitor_.start();
  }

  /// A state without a time since the previous one (dt_s is 0) begins a drive.
  MonitorOutput update(const FilterState& state, const SweepCondition& condition) {
    if (!(state.dt_s > 0.0)) beginDrive(state);
    asked_ = false;
    odom_reset_count_ = state.odom_reset_count;
    return monitor_.update(state, condition);
  }

  /// The odometry serves as the localisation from the next sweep on (FailAwareMonitor::start).
  void serve() {
    monitor_.start();
    asked_ = true;
  }

  /// The localisation of before serves again. False: it always serves, and goes on.
  bool stopServing() {
    if (always_serves_) return false;
    monitor_.stop();
    asked_ = false;
    return true;
  }

  void setLimits(const MonitorParameters& params) {
    params_ = params;
    monitor_.setLimits(params);
  }

  const MonitorParameters& params() const { return params_; }
  const FailAwareMonitor& monitor() const { return monitor_; }

 private:
  void beginDrive(const FilterState& state) {
    // a pose that was set raises the count; a filter that was started anew counts from 0
    const bool odom_goes_on = monitor_.isWhereItWas(state) || state.odom_reset_count > odom_reset_count_;
    const bool serves = always_serves_ || asked_ || (monitor_.startPending() && odom_goes_on);
    monitor_ = FailAwareMonitor(params_);
    if (serves) monitor_.start();
  }

  MonitorParameters params_;
  bool always_serves_;
  FailAwareMonitor monitor_;
  bool asked_ = false;        ///< requested since the last filter state
  int odom_reset_count_ = 0;  ///< of the last filter state
};

}  // namespace fail_aware
