// A recorded run (offline_odometry's folder) with its ground truth: the input of the fail-aware tools.
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/io/measurement_log.hpp"
#include "core/pipeline_parameters.hpp"
#include "core/types/monitor_input.hpp"
#include "evaluation/fail_aware_episode.hpp"

namespace fail_aware {

struct FailAwareRun {
  std::string name;              ///< the folder's
  PoseFilter::Params made_with;  ///< what its increments were logged with
  PipelineParameters params;     ///< with the changes of FailAwareRunOptions
  std::vector<MonitorInput> log;
  std::vector<MeasuredMotion> measurements;  ///< empty if the run was made before they were logged
  std::vector<double> fault_begins_s;        ///< in the log's time, of faults.csv (simulate_drive) if the folder has it
  std::vector<Pose> truth;                   ///< of the centre of gravity, one for each entry of `log`
  std::vector<std::string> unused_keys;      ///< that FailAwareRunOptions would change, without any effect
};

struct FailAwareRunOptions {
  std::vector<std::string> ground_truths, runs;
  std::string calib;
  std::vector<std::string> parameters, set;
  std::vector<std::string> used_keys = {"monitor."};  ///< what the keys begin with that have an effect
  std::string tool;                                   ///< its name, for warnings
};

void addRunOptions(CLI::App& app, FailAwareRunOptions& options);

/// The n-th ground truth belongs to the n-th run. The monitor's parameters are those of the runs, changed by
/// `parameters` (yaml files that may name only some keys, applied in order) and `set`. Warns if one of the files would
/// change a key without an effect. Throws InputError, ParameterError; for such a key in `set`, too.
std::vector<FailAwareRun> loadRuns(const FailAwareRunOptions& options);

/// The episodes of runs[index], with its faults, replayed with `monitor`.
std::vector<FailAwareEpisode> episodesOf(const std::vector<FailAwareRun>& runs, std::size_t index,
                                         const MonitorParameters& monitor, const FailureEpisode::Params& params);

/// --alert-limit: the error that counts as a failure; if it is not given, the limit of the replayed monitor counts.
void addAlertLimitOption(CLI::App& app, std::optional<double>& alert_limit_m);
/// Throws InputError if the runs' limits differ and none is given.
double alertLimitOf(const std::vector<FailAwareRun>& runs, const std::optional<double>& given_m);

}  // namespace fail_aware
