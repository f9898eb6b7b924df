// A measurement nodelet's diagnostics: its last measurement, and how many of its sweeps gave a pose.
// Units m, s. No failure modes.
#pragma once

#include "fail_aware_lidar_odometry/PoseMeasurement.h"
#include <diagnostic_updater/DiagnosticStatusWrapper.h>

#include <cstddef>

#include "core/types/measurement.hpp"
#include "sweep_progress.hpp"

namespace fail_aware {

class MeasurementRecord {
 public:
  /// `message`: the published measurement; `status`: its status.
  void add(const ::fail_aware_lidar_odometry::PoseMeasurement& message, MeasurementStatus status) {
    last_ = message;
    last_status_ = status;
    if (status == MeasurementStatus::kOk) ++usable_;
    progress_.done(message.header.stamp);
  }
  /// A prediction with an invalid pose.
  void addUnusable() { ++unusable_; }

  /// `skipped`: number of dropped sweeps (SweepMatcher).
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status, std::size_t skipped) {
    const char* summary = progress_.sweeps() == 0 ? "no sweep yet" : toString(last_status_);
    status.summary(diagnostic_msgs::DiagnosticStatus::OK, summary);
    progress_.diagnose(status, "sweep");
    status.add("sweeps with a pose", usable_);
    status.addf("ms", "%.1f", 1e3 * last_.duration);
    status.addf("rms residual (m)", "%.3f", last_.rms_residual);
    status.addf("inlier ratio", "%.2f", last_.inlier_ratio);
    status.addf("seed spread (m)", "%.3f", last_.seed_spread);
    status.add("degenerate directions", static_cast<int>(last_.degenerate_directions));
    status.addf("weakest direction's information ratio", "%.3f", last_.min_information_ratio);
    status.add("sweeps skipped", skipped);
    status.add("predictions not usable", unusable_);
  }

 private:
  ::fail_aware_lidar_odometry::PoseMeasurement last_;
  MeasurementStatus last_status_ = MeasurementStatus::kNoReference;
  std::size_t usable_ = 0, unusable_ = 0;
  SweepProgress progress_;
};

}  // namespace fail_aware
