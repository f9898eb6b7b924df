// per_sweep.csv, monitor_log.csv, measurements.csv and the timing summary of a run.
//
// cov_*: the accumulated covariance since t1 (m, rad; in the axes at t1; zero before t1). speed_mps, yaw_rate_rps: from
// the last increment of the centre of gravity.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "core/odometry_pipeline.hpp"
#include "json.hpp"

namespace fail_aware {

class SweepLog {
 public:
  /// Throws InputError if a file cannot be opened.
  explicit SweepLog(const std::filesystem::path& folder);

  void add(double stamp_s, const SweepResult& result);

  /// False: the sweep has no pose of its own; it has a row in per_sweep.csv but not in the other files.
  static bool hasPose(SweepStatus status) {
    return status != SweepStatus::kStampNotAdvancing && status != SweepStatus::kNotStarted;
  }

  std::size_t sweeps() const { return total_ms_.size(); }
  /// Their rows in per_sweep.csv, counted from 0.
  const std::vector<std::size_t>& withoutPose() const { return without_pose_; }
  /// Sweeps without point times of their own, timed as those before.
  std::size_t timedAsBefore() const;
  std::size_t count(SweepStatus status) const { return by_status_[static_cast<std::size_t>(status)]; }

  /// mean_ms, median_ms, p95_ms, p99_ms, counts by status, and how the points were timed.
  Json summary() const;

  /// One line each, for the user: sweeps with assumed point times; a driver whose clouds are all incomplete.
  std::vector<std::string> warnings() const;

  /// Throws std::runtime_error if the file could not be completed.
  void close();

 private:
  void logSweep(std::size_t row, const SweepResult& result);

  std::string path_, monitor_path_, measurement_path_;
  std::ofstream out_, monitor_log_, measurement_log_;
  std::vector<double> total_ms_;
  std::vector<std::size_t> by_status_, without_pose_;
  std::map<TimingSource, std::size_t> by_timing_;
  std::size_t guessed_ = 0, outliers_ = 0, incomplete_ = 0;
  TimingResult timing_;  ///< of the last sweep that was guessed(), otherwise of the last sweep
};

}  // namespace fail_aware
