// A stage's progress for its diagnostics: number of sweeps, rate (Hz, steady clock), age of the last one (s, ROS time).
// No failure modes.
#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <ros/time.h>

#include <cstddef>
#include <string>

#include "rate_meter.hpp"
#include "stamps.hpp"

namespace fail_aware {

class SweepProgress {
 public:
  /// `stamp`: the sweep's.
  void done(const ros::Time& stamp) {
    ++sweeps_;
    rate_.tick();
    last_stamp_ = stamp;
  }
  /// A new drive without a finished sweep. The count stays.
  void forgetLast() { last_stamp_ = ros::Time(); }
  std::size_t sweeps() const { return sweeps_; }

  /// `what`: the user's name for a sweep's result.
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status, const std::string& what) {
    status.addf("rate (Hz)", "%.2f", rate_.take_hz());
    if (!last_stamp_.isZero()) {
      status.addf("age of the last " + what + " (s)", "%.3f", secondsFrom(last_stamp_, ros::Time::now()));
    }
    status.add("sweeps", sweeps_);
  }

 private:
  std::size_t sweeps_ = 0;
  RateMeter rate_;
  ros::Time last_stamp_;  ///< zero: none
};

}  // namespace fail_aware
