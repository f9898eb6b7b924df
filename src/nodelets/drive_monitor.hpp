// The fail-aware monitor (core/fail_aware/monitor.hpp) over several drives: with each drive, odom and the monitor begin
// anew. Whoever relied on the last drive's odometry must ask again; a request that still waits for an observed motion
// stays, as does one that came after the last filter state. Where it always serves (start_redundant), nobody has to ask.
// Failure and cost: those of FailAwareMonitor.
#pragma once

#include "fail_aware_lidar_odometry/core/fail_aware/monitor.hpp"

namespace fail_aware {

class DriveMonitor {
 public:
  DriveMonitor(const MonitorParameters& params, bool always_serves)
      : params_(params), always_serves_(always_serves), monitor_(params) {
    if (always_serves_) monitor_.start();
  }

  /// A state without a time since the last one begins a drive.
  MonitorOutput update(const FilterState& state, const SweepCondition& condition) {
    if (!(state.dt_s > 0.0)) beginDrive();
    asked_ = false;
    return monitor_.update(state, condition);
  }

  /// The odometry serves as the localisation from the next sweep on whose motion is observed.
  void serve() {
    monitor_.start();
    asked_ = true;
  }

  void setLimits(const MonitorParameters& params) {
    params_ = params;
    monitor_.setLimits(params);
  }

  const MonitorParameters& params() const { return params_; }
  const FailAwareMonitor& monitor() const { return monitor_; }

 private:
  void beginDrive() {
    const bool serves = always_serves_ || asked_ || monitor_.startPending();
    monitor_ = FailAwareMonitor(params_);
    if (serves) monitor_.start();
  }

  MonitorParameters params_;
  bool always_serves_;
  FailAwareMonitor monitor_;
  bool asked_ = false;  ///< since the last filter state
};

}  // namespace fail_aware
