#include "drive_results.hpp"

#include <cstdio>
#include <utility>

#include "core/integrity/monitor_replay.hpp"
#include "core/parameters/yaml_parameters.hpp"
#include "core/preprocessing/stamp_fault.hpp"
#include "tool_support.hpp"

namespace fail_aware {

void DriveResults::add(const ReadResult& read, const std::string& name, double stamp_s, std::size_t points_dropped,
                       const SweepResult& result) {
  if (!read.hasPoints()) bad_scans_.push_back({name, read.message});
  if (read.status == ReadStatus::kSideFileUnusable && side_files_unusable_++ == 0) side_file_fault_ = read.message;
  if (!read.hasPoints() || result.status == SweepStatus::kNotStarted) ++unusable_;
  points_dropped_ += points_dropped;
  const bool is_unknown = result.monitor.state == FailAwareState::kUnknown;
  const bool motion_unknown = is_unknown && (result.monitor.reasons & kReasonMotionUnknown) != 0;
  motion_unknown_sweeps_ = motion_unknown ? motion_unknown_sweeps_ + 1 : 0;
  if (result.monitor.t1_stamp_s >= 0.0) t1_stamp_s_ = result.monitor.t1_stamp_s;
  log_.add(stamp_s, result);
  if (std::string fault = fail_aware::stampFault(params_.sensor.timing, result.timing); !fault.empty()) {
    stamp_fault_ = std::move(fault);
  }
  last_ = result;
  if (!SweepLog::hasPose(result.status)) return;
  const Pose T_odom_lidar = result.T_odom_base * params_.sensor.T_base_lidar();
  if (lidar_trajectory_.empty()) T_odom_lidar_first_ = T_odom_lidar;
  lidar_trajectory_.push_back(orthonormalized(T_odom_lidar_first_.inverse() * T_odom_lidar));
  if (!base_trajectory_.empty()) {
    const StampedPose& before = base_trajectory_.back();
    if (stamp_s <= before.stamp_s) ++set_back_;
    const bool driven = !result.pose_set.done;  // a pose that was set moves odom, not the vehicle
    if (driven) distance_m_ += (result.T_odom_base.translation() - before.T.translation()).norm();
  }
  base_trajectory_.push_back({stamp_s, result.T_odom_base});
}

std::vector<std::string> DriveResults::warnings() const {
  std::vector<std::string> lines;
  for (const BadScan& bad : bad_scans_) {
    if (lines.size() == kBadScansNamed) {
      lines.push_back(std::to_string(bad_scans_.size() - kBadScansNamed) +
                      " more such scans: bad_scans in summary.json");
      break;
    }
    lines.push_back(bad.reason + "; carried on as over a dropped sweep");
  }
  if (const std::size_t unusable = log_.count(SweepStatus::kNotStarted)) {
    lines.push_back("the odometry begins at the first sweep with usable points; " + counted(unusable, "sweep") +
                    " without usable points (" + toString(SweepStatus::kNotStarted) +
                    " in per_sweep.csv) have no row in the trajectories");
  }
  if (const std::size_t refused = log_.count(SweepStatus::kStampNotAdvancing)) {
    lines.push_back("the stamps of " + std::to_string(refused) + " of " + std::to_string(log_.sweeps()) +
                    " sweeps were refused (duplicate, out of order, far ahead): " +
                    toString(SweepStatus::kStampNotAdvancing) + " in per_sweep.csv, no row in the trajectories");
  }
  if (side_files_unusable_ > 0) {
    lines.push_back("in " + std::to_string(side_files_unusable_) + " of " + std::to_string(log_.sweeps()) +
                    " sweeps the file of the points' times or rings is not used, first " + side_file_fault_ + "; " +
                    std::to_string(log_.timedAsBefore()) + " timed as those before");
  }
  if (set_back_ > 0) {
    lines.push_back("the clock was set back " + std::to_string(set_back_) +
                    " times; the trajectories keep the order of the recording, the stamps of trajectory_tum.txt go "
                    "back there");
  }
  // several sweeps of which none can be used have another cause than half revolutions: the first alone is left out
  if (withoutAnyPose() && log_.sweeps() > 1) return lines;
  const std::vector<std::string> of_log = log_.warnings();
  lines.insert(lines.end(), of_log.begin(), of_log.end());
  if (motion_unknown_sweeps_ > 0) {
    lines.push_back("the state is UNKNOWN (MOTION_UNKNOWN) to the end, for " +
                    counted(motion_unknown_sweeps_, "sweep") +
                    ": no motion was observed; a planner must act as in FAILED");
  } else if (!t1_stamp_s_) {
    lines.push_back("the drive ended before --redundant-at: there is no t1, every state is UNKNOWN");
  }
  return lines;
}

void DriveResults::write() {
  writeKittiTrajectory((folder_ / "trajectory_kitti.txt").string(), lidar_trajectory_);
  writeTumTrajectory((folder_ / "trajectory_tum.txt").string(), base_trajectory_);
  saveYaml((folder_ / "parameters.yaml").string(), params_);
  log_.close();
}

/// Facts about the run that a reader of per_sweep.csv needs.
Json DriveResults::describeRun(const Drive& drive) const {
  const MonitorParameters& monitor = params_.profile.monitor;
  Json json;
  json["first"] = drive.first;
  json["scans"] = log_.sweeps();
  json["drive_scans"] = drive.scans;
  json["drive_begin_stamp_s"] = drive.begin_stamp_s;
  json["without_pose"] = log_.withoutPose();
  json["t1_stamp_s"] = t1_stamp_s_ ? Json(*t1_stamp_s_) : Json(nullptr);
  json["eta_threshold_rad"] = monitor.indicator.threshold;
  json["horizon_s"] = monitor.predictor.horizon_s;
  json["alert_limit_m"] = monitor.predictor.alert_limit_m;
  json["comfortable_deceleration_mps2"] = monitor.thresholds.comfortable_deceleration_mps2;
  json["failing_s"] = monitor.thresholds.failing_s;
  json["degraded_s"] = monitor.thresholds.degraded_s;
  json["lidar_in_base"] = params_.sensor.lidar_in_base;
  return json;
}

Json DriveResults::summary(const Drive& drive) const {
  Json summary = log_.summary();
  summary["distance_m"] = distance_m_;
  summary["final_state"] = toString(last_.monitor.state);
  summary["dropped"] = bad_scans_.size();
  summary["bad_scans"] = Json::array();
  for (const BadScan& bad : bad_scans_) summary["bad_scans"].push_back({{"file", bad.file}, {"reason", bad.reason}});
  summary["points_not_finite_or_zero"] = points_dropped_;
  summary["run"] = describeRun(drive);
  return summary;
}

std::string DriveResults::verdict() const {
  const double duration_s =
      base_trajectory_.empty() ? 0.0 : base_trajectory_.back().stamp_s - base_trajectory_.front().stamp_s;
  std::string reasons = reasonText(last_.monitor.reasons);
  if (!reasons.empty()) reasons = " (" + reasons + ")";
  char text[200];
  std::snprintf(text, sizeof text, "%.1f m in %.1f s, %s, %zu without usable points, %zu refused; final state ",
                distance_m_, duration_s, counted(log_.sweeps(), "sweep").c_str(), unusable_,
                log_.count(SweepStatus::kStampNotAdvancing));
  return text + std::string(toString(last_.monitor.state)) + reasons;
}

}  // namespace fail_aware
