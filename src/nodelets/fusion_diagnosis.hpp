// FusionUkf's diagnostics: the status `odometry` and its warnings in the log. The status names the first obstacle
// between the cloud and an estimate. Every cloud without an estimate is counted by its cause.
// Times: s, steady clock; ages: ROS time. No failure modes. Single-threaded.
#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <ros/time.h>

#include <cstddef>
#include <string>
#include <utility>

#include "cloud_intake.hpp"
#include "core/estimation/sweep_scheduler.hpp"
#include "core/estimator.hpp"
#include "measurement_sources.hpp"
#include "published_type.hpp"
#include "spoken_faults.hpp"
#include "sweep_progress.hpp"

namespace fail_aware {

class FusionDiagnosis {
 public:
  /// The arguments must outlive this object. `cloud_topic`: resolved name.
  FusionDiagnosis(const std::string& cloud_topic, const CloudIntake& clouds, const SweepScheduler& scheduler,
                  const MeasurementSources& sources, const Estimator& estimator)
      : cloud_topic_(cloud_topic), clouds_(clouds), scheduler_(scheduler), sources_(sources), estimator_(estimator) {}

  /// Call after publishing a sweep's estimate. `arrived_s`: arrival of its cloud, steady clock.
  void closed(const ros::Time& stamp, double arrived_s) {
    const FilterState& state = estimator_.state();
    if (!state.measurement_applied && state.dt_s > 0.0) ++predicted_only_;
    last_corrected_ = state.measurement_applied;
    arrived_s_ = arrived_s;
    latency_s_ = ros::SteadyTime::now().toSec() - arrived_s;
    progress_.done(stamp);
    for (const RefusedPose& pose : estimator_.refusedPoses()) {
      faults_.say("pose of " + pose.source, "the pose of " + pose.source + " is not used: " + pose.why);
    }
  }

  /// Call when the stamps jumped and a new drive begins.
  void jumped(double by_s) {
    faults_.say("jump", "stamps jumped by " + std::to_string(by_s) + " s: a new drive begins");
    ++time_jumps_;
  }

  void newDrive() {
    progress_.forgetLast();
    if (progress_.sweeps() > 0) ++resets_;
  }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
    summarize(status);
    progress_.diagnose(status, "estimate");
    status.addf("from cloud to estimate (ms)", "%.1f", 1e3 * latency_s_);
    status.add("sweeps without a usable measurement", predicted_only_);
    const SweepClock& clock = estimator_.sweepClock();
    status.addf("period of the head (ms)", "%.3f", 1e3 * clock.period_s().value_or(0.0));
    status.addf("jitter of the stamps (ms)", "%.3f", 1e3 * clock.jitter_s().value_or(0.0));
    status.add("stamps that the period contradicts", clock.outliers());
    addDropped(status);
    status.add("resets", resets_);
    status.add("resets because stamps jumped", time_jumps_);
  }

 private:
  static constexpr double kSilent_s = 2.0;  ///< time without a sweep that gives a diagnostic
  static constexpr double kStarts_s = 8.0;  ///< start-up time of the other nodes, without warnings in the log

  static double secondsSince(const ros::SteadyTime& then) { return (ros::SteadyTime::now() - then).toSec(); }

  void summarize(diagnostic_updater::DiagnosticStatusWrapper& status) {
    using Level = diagnostic_msgs::DiagnosticStatus;
    const bool starts = secondsSince(loaded_at_) <= kStarts_s;
    const std::string absent = sources_.absent(), clock_fault = clouds_.clock().fault();
    const std::string no_usable_cloud = "no cloud that can be used: " + scheduler_.lastRefused();
    if (!starts) faults_.say("clock", clock_fault);
    if (!clouds_.lidar().known() && !clouds_.lidar().fault().empty()) {
      status.summary(Level::ERROR, clouds_.lidar().fault());
      faults_.say("transform", clouds_.lidar().fault());
    } else if (clouds_.heardAt().isZero()) {
      const std::string type = publishedType(cloud_topic_);
      status.summary(Level::WARN, whyNoCloud(cloud_topic_, type));
      if (!starts) faults_.say("no cloud", status.message);
    } else if (progress_.sweeps() == 0) {
      status.summary(Level::WARN, scheduler_.lastRefused().empty() ? "no sweep yet" : no_usable_cloud);
    } else if (const double silent_s = secondsSince(clouds_.heardAt()); silent_s > kSilent_s) {
      status.summaryf(Level::WARN, "no cloud for %.0f s", silent_s);
    } else if (!scheduler_.current() && ros::SteadyTime::now().toSec() - arrived_s_ > kSilent_s) {
      status.summary(Level::WARN, no_usable_cloud);
    } else if (!absent.empty()) {
      status.summary(Level::WARN, "no answer from" + absent);
    } else if (!clock_fault.empty()) {
      status.summary(Level::WARN, clock_fault);
    } else if (!last_corrected_ && progress_.sweeps() > 1) {
      status.summary(Level::WARN, "prediction only");
    } else {
      status.summary(Level::OK, "running");
    }
  }

  void addDropped(diagnostic_updater::DiagnosticStatusWrapper& status) {
    const SweepScheduler::Counts& dropped = scheduler_.counts();
    const std::pair<std::string, std::size_t> causes[] = {
        {"overload", dropped.overload},
        {"duplicate stamp", dropped.duplicate},
        {"stamp out of order", dropped.reordered},
        {"stamp far ahead", dropped.far_ahead},
        {"stamp not usable", dropped.unusable_stamp},
        {"frame is not " + clouds_.lidar().lidarFrame(), dropped.wrong_frame},
        {"no transform", clouds_.lost()}};
    for (const auto& [cause, count] : causes) {
      status.add("dropped: " + cause, count);
      faults_.count("clouds dropped: " + cause, count);
    }
    status.add("dropped: by a reset", dropped.reset);
  }

  std::string cloud_topic_;
  const CloudIntake& clouds_;
  const SweepScheduler& scheduler_;
  const MeasurementSources& sources_;
  const Estimator& estimator_;
  SweepProgress progress_;
  bool last_corrected_ = false;
  double arrived_s_ = 0.0;  ///< arrival of the last estimate's cloud
  double latency_s_ = 0.0;  ///< of the last estimate
  std::size_t predicted_only_ = 0, resets_ = 0, time_jumps_ = 0;
  SpokenFaults faults_{"odometry"};
  ros::SteadyTime loaded_at_ = ros::SteadyTime::now();
};

}  // namespace fail_aware
