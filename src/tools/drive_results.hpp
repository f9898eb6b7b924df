// The results of an offline_odometry run: trajectories, logs, summary, warnings, verdict.
//
// Trajectories contain the sweeps with a pose of their own (SweepLog::hasPose), in the order of the recording.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/io/sweep_source.hpp"
#include "core/io/trajectory_io.hpp"
#include "core/odometry_pipeline.hpp"
#include "json.hpp"
#include "sweep_log.hpp"

namespace fail_aware {

class DriveResults {
 public:
  /// Writes the logs into `folder` while sweeps are added. Throws InputError if a file cannot be opened.
  DriveResults(const std::filesystem::path& folder, const PipelineParameters& params)
      : folder_(folder), params_(params), log_(folder) {}

  /// A scan as read, and the odometry's result for it. `name`: the scan's, for messages.
  void add(const ReadResult& read, const std::string& name, double stamp_s, std::size_t points_dropped,
           const SweepResult& result);

  std::size_t sweeps() const { return log_.sweeps(); }
  bool withoutAnyPose() const { return base_trajectory_.empty(); }

  /// One line each, for the user.
  std::vector<std::string> warnings() const;
  /// The last contradiction between the points' times and the stamps' reference (preprocessing/stamp_fault.hpp).
  const std::string& stampFault() const { return stamp_fault_; }

  /// Writes trajectories and parameters, and closes the logs. Throws std::runtime_error.
  void write();

  struct Drive {     ///< what the run is a part of
    long first = 0;  ///< index of the run's first scan
    std::size_t scans = 0;
    double begin_stamp_s = 0.0;  ///< of the drive's first scan
  };
  Json summary(const Drive& drive) const;

  /// One line: distance, time, sweeps, dropped sweeps, the last state.
  std::string verdict() const;

 private:
  struct BadScan {
    std::string file, reason;
  };
  Json describeRun(const Drive& drive) const;

  std::filesystem::path folder_;
  PipelineParameters params_;
  SweepLog log_;
  std::vector<Pose> lidar_trajectory_;  ///< the first one is the identity
  std::vector<StampedPose> base_trajectory_;
  Pose T_odom_lidar_first_ = Pose::Identity();
  double distance_m_ = 0.0;
  std::vector<BadScan> bad_scans_;
  std::size_t points_dropped_ = 0, unusable_ = 0, set_back_ = 0, side_files_unusable_ = 0;
  std::string side_file_fault_;            ///< of the first such sweep
  std::optional<double> t1_stamp_s_;       ///< the last one: a pose that is set begins a new one
  std::size_t motion_unknown_sweeps_ = 0;  ///< at the end
  std::string stamp_fault_;
  SweepResult last_;
};

}  // namespace fail_aware
