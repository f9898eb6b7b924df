// SweepCorrection's diagnostics: the status `sweep_correction` and its warnings in the log. They report whether the
// clouds are readable, what the sweep check found (core/preprocessing/sweep_check.hpp), and whether the stamps and the
// point times agree with the parameters. Units s. No failure modes. Single-threaded.
#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <ros/console.h>
#include <ros/time.h>

#include <cstddef>
#include <string>
#include <utility>

#include "clock_check.hpp"
#include "core/preprocessing/stamp_fault.hpp"
#include "core/preprocessing/sweep_check.hpp"
#include "core/preprocessing/sweep_corrector.hpp"
#include "core/types/corrected_sweep.hpp"
#include "core/types/sweep_findings.hpp"
#include "fail_aware_lidar_odometry/bridge/point_cloud_conversion.hpp"
#include "fail_aware_lidar_odometry/sweep.hpp"
#include "spoken_faults.hpp"
#include "sweep_progress.hpp"

namespace fail_aware {

class CorrectionDiagnosis {
 public:
  explicit CorrectionDiagnosis(const SweepTimingParams& params) : params_(params) {}

  /// Call for each cloud on arrival.
  void heard(const ros::Time& stamp) {
    clock_.heard(stamp);
    ++heard_;
  }
  /// Call for each prediction.
  void predicted() { heard_ = 0; }
  /// Call for each corrected sweep: how its cloud was read, the sweep, the findings and the corrector's report.
  void add(const ros::Time& stamp, const CloudReadResult& read, const Sweep& sweep, const SweepFindings& findings,
           const SweepCorrectorReport& report) {
    findings_ = findings;
    report_ = report;
    points_ = sweep.size();
    time_field_name_ = sweep.time_field.name;
    if (!read.ok()) refused_.add(read.reason);
    if (report.timing.guessed()) guessed_.add(describeGuess(report.timing));
    if (report.timing.source == TimingSource::kHeld) ++held_;
    tellIfTimedByAzimuth(report.timing);
    outliers_ += report.timing.outliers;
    progress_.done(stamp);
  }

  /// `seam_contradiction`: from SweepCorrector. `unmatched`: number of clouds without a prediction.
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status, const std::string& seam_contradiction,
                std::size_t unmatched) {
    summarize(status, seam_contradiction);
    progress_.diagnose(status, "sweep");
    status.add("points of the last sweep", points_);
    status.addf("azimuth coverage", "%.2f", findings_.azimuth_coverage);
    status.addf("range of view (m)", "%.1f", findings_.view_range_m);
    status.add("repetitions", findings_.repetitions);
    status.add("clouds without usable points", refused_.count);
    status.add("clouds without a prediction", unmatched);
    status.add("timing source", toString(report_.timing.source));
    status.add("stamp reference", toString(report_.timing.reference));
    status.addf("age of the clouds on arrival (s)", "%.3f", clock_.age_s());
    status.add("time field", toString(report_.timing.field));
    status.add("time field's name", time_field_name_);
    status.add("sweeps timed by a guess", guessed_.count);
    status.add("sweeps timed as those before", held_);
    status.add("points without a usable time", outliers_);
    status.add("correction", toString(report_.correction));
  }

 private:
  /// An event that causes a warning only if it happened again since the last warning.
  struct Event {
    std::size_t count = 0, told = 0;
    std::string last_reason;

    void add(const std::string& reason) {
      ++count;
      last_reason = reason;
    }
    bool isNew() const { return count > told; }
  };

  /// Once: the user may expect a time field of this driver.
  void tellIfTimedByAzimuth(const TimingResult& timing) {
    const bool is = timing.field == TimeField::kAbsent && timing.source == TimingSource::kAzimuth;
    if (!is || std::exchange(azimuth_told_, true)) return;
    ROS_INFO(
        "sweep_correction: the clouds have no time field: the points' times are taken from their azimuth, by "
        "sensor.timing.start_azimuth_deg (%g) and clockwise (%s)",
        params_.start_azimuth_deg, params_.clockwise ? "true" : "false");
  }

  void summarize(diagnostic_updater::DiagnosticStatusWrapper& status, const std::string& seam_contradiction) {
    using Level = diagnostic_msgs::DiagnosticStatus;
    const std::string clock_fault = clock_.fault();
    const std::string timing_fault =
        seam_contradiction.empty() ? stampFault(params_, report_.timing, clock_.age_s()) : seam_contradiction;
    faults_.say("timing", timing_fault);
    if (refused_.isNew()) {
      status.summary(Level::WARN, "clouds without usable points: " + refused_.last_reason);
      faults_.say("points", status.message);
    } else if (findings_.frozen) {
      status.summary(Level::WARN, "the sweep is frozen: the driver repeats itself");
    } else if (findings_.incomplete) {
      status.summary(Level::WARN, describeIncomplete());
    } else if (findings_.low_visibility) {
      status.summary(Level::WARN, "the sweep is cut short in range");
    } else if (guessed_.isNew()) {
      status.summary(Level::WARN, guessed_.last_reason);
    } else if (!timing_fault.empty()) {
      status.summary(Level::WARN, timing_fault);
    } else if (!clock_fault.empty()) {
      status.summary(Level::WARN, clock_fault);
    } else if (heard_ >= kManyHeard) {
      status.summary(Level::WARN, "no predictions for the clouds: fusion_ukf does not run, or refuses them");
    } else {
      status.summary(Level::OK, progress_.sweeps() == 0 ? "no sweep yet" : "correcting");
    }
    refused_.told = refused_.count;
    guessed_.told = guessed_.count;
  }

  static constexpr int kManyHeard = 100;  ///< more than come while the first motion is searched for

  SweepTimingParams params_;
  int heard_ = 0;                            ///< clouds since the last prediction
  ClockCheck clock_;                         ///< of the clouds' stamps
  SpokenFaults faults_{"sweep_correction"};  ///< warnings in the log
  SweepProgress progress_;
  SweepFindings findings_;  ///< this and the following: of the last sweep
  SweepCorrectorReport report_;
  std::size_t points_ = 0;
  std::string time_field_name_;
  Event refused_;  ///< clouds without usable points
  Event guessed_;  ///< sweeps with assumed point times
  std::size_t held_ = 0, outliers_ = 0;
  bool azimuth_told_ = false;
};

}  // namespace fail_aware
