// A recorded run (offline_odometry's folder) with its ground truth: what the fail-aware tools start from.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "fail_aware_lidar_odometry/core/io/monitor_log.hpp"
#include "fail_aware_lidar_odometry/core/pipeline_parameters.hpp"

namespace fail_aware {

struct FailAwareRun {
  std::string name;  ///< the folder's
  PipelineParameters params;
  std::vector<MonitorInput> log;
  std::vector<Pose> truth;  ///< of the centre of gravity, one for each entry of `log`
};

struct FailAwareRunOptions {
  std::vector<std::string> ground_truths, runs;
  std::string calib, parameters;
  std::vector<std::string> set;
};

void addRunOptions(CLI::App& app, FailAwareRunOptions& options);

/// The n-th ground truth belongs to the n-th run. The monitor's parameters are those of the runs, changed by
/// `parameters` (a yaml file that may name some keys only) and `set`. Throws InputError, ParameterError.
std::vector<FailAwareRun> loadRuns(const FailAwareRunOptions& options);

}  // namespace fail_aware
