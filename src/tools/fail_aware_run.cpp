#include "fail_aware_run.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "core/io/input_error.hpp"
#include "core/io/monitor_log.hpp"
#include "core/io/number_table.hpp"
#include "core/io/profile_files.hpp"
#include "core/io/text_lines.hpp"
#include "core/io/trajectory_io.hpp"
#include "core/parameters/yaml_parameters.hpp"
#include "evaluation/trajectory_pair.hpp"
#include "run_folder.hpp"
#include "tool_support.hpp"

namespace fail_aware {

namespace {

namespace fs = std::filesystem;

/// The second column of simulate_drive's faults.csv, s since the drive's first sweep.
std::vector<double> readFaultBegins(const fs::path& path) {
  std::vector<double> begins_s;
  std::ifstream file(path);
  if (!file) return begins_s;
  skipByteOrderMark(file, path.string());
  std::string line;
  nextLine(file, line);  // the header
  for (std::size_t number = 2; nextLine(file, line); ++number) {
    if (line.empty()) continue;
    try {
      number_table::Cells cells(line);
      cells.next();
      begins_s.push_back(number_table::numberFrom(cells.next()));
    } catch (const InputError& error) {
      throw InputError(path.string() + ':' + std::to_string(number) + ": " + error.what() +
                       "; a line is kind,start_s,duration_s,severity");
    }
  }
  return begins_s;
}

/// The truth knows nothing of a pose that was set, or of a drive that began anew: the jump would count as an error.
void requireOneDrive(const std::vector<MonitorInput>& log, const fs::path& path) {
  for (std::size_t i = 1; i < log.size(); ++i) {
    const FilterState &before = log[i - 1].state, &now = log[i].state;
    const auto refuse = [&](const char* what, const char* remedy) {
      throw InputError(path.string() + ": " + what + " at stamp " + std::to_string(now.stamp_s) + remedy);
    };
    if (now.odom_reset_count != before.odom_reset_count) refuse("a pose was set", ": make the run without --set-pose");
    const bool begins_anew = !(now.dt_s > 0.0) && before.dt_s > 0.0;
    if (begins_anew || now.stamp_s < before.stamp_s) {
      refuse("the stamps jump",
             ", where a new drive began: make a run of each part (offline_odometry --first, --count)");
    }
  }
}

bool hasEffect(const std::string& key, const FailAwareRunOptions& options) {
  return std::any_of(options.used_keys.begin(), options.used_keys.end(),
                     [&](const std::string& begin) { return key.rfind(begin, 0) == 0; });
}

void requireEffectOfSet(const FailAwareRunOptions& options) {
  std::string used;
  for (const std::string& begin : options.used_keys) used += (used.empty() ? "" : " and ") + begin;
  for (const std::string& setting : options.set) {
    if (hasEffect(setting, options)) continue;
    throw InputError("--set " + setting + ": only keys of " + used +
                     " have an effect here: run offline_odometry with it");
  }
}

void warnOfUnusedKeys(const FailAwareRun& run, const FailAwareRunOptions& options) {
  const std::size_t more = run.unused_keys.size() - 1;
  std::cerr << options.tool << ": warning: " << run.name << " was made with another " << run.unused_keys.front()
            << " than --parameters gives" << (more > 0 ? " (and " + std::to_string(more) + " more keys)" : "")
            << ", which has no effect here: run offline_odometry with it" << std::endl;
}

FailAwareRun loadRun(const std::string& folder, const std::string& ground_truth, const FailAwareRunOptions& options) {
  FailAwareRun run;
  fs::path path(folder);
  if (path.filename().empty()) path = path.parent_path();
  run.name = path.filename().string();
  const RunRows rows = runRows(readRunSummary(path), path / "summary.json");
  run.log = readMonitorLog((path / "monitor_log.csv").string());
  requireOneDrive(run.log, path);
  for (const double begin_s : readFaultBegins(path / "faults.csv")) {
    run.fault_begins_s.push_back(rows.drive_begin_stamp_s + begin_s);
  }
  const fs::path measurements = path / "measurements.csv";
  if (fs::exists(measurements)) run.measurements = readMeasurementLog(measurements.string());
  // A run made before a parameter existed behaves as with its default.
  loadYaml((path / "parameters.yaml").string(), run.params, MissingKeys::kKeep);
  run.made_with = run.params.profile.filter;
  // the lidar was where the run had it, whatever the monitor is replayed with
  const Pose T_lidar_cog = run.params.sensor.T_base_lidar().inverse() * run.params.vehicle.T_base_cog();
  const ParameterList of_run = toList(run.params);
  overrideParameters(run.params, options.parameters, options.set);
  const ParameterList changed = toList(run.params);
  for (std::size_t i = 0; i < changed.size(); ++i) {
    if (changed[i] != of_run[i] && !hasEffect(changed[i].first, options)) run.unused_keys.push_back(changed[i].first);
  }

  std::vector<Pose> poses = readKittiTrajectory(ground_truth);
  if (!options.calib.empty()) poses = lidarFromCameraTrajectory(poses, readLidarToCamera(options.calib));
  if (movesLikeACamera(poses)) {
    throw InputError(ground_truth + ": it " + kMovesLikeACamera + ": give --calib calib.txt");
  }
  const std::size_t first = firstTruthRow(rows, poses.size(), ground_truth, path.string());
  for (const MonitorInput& input : run.log) {
    if (input.row < rows.scans) continue;
    throw InputError((path / "monitor_log.csv").string() + ": has row " + std::to_string(input.row) + " of " +
                     std::to_string(rows.scans) + " scans");
  }
  std::vector<Pose> estimate;
  for (const MonitorInput& input : run.log) {
    run.truth.push_back(poses[first + input.row] * T_lidar_cog);
    estimate.push_back(input.state.T_odom_cog);
  }
  if (const std::string fault = extentFault(run.truth, estimate); !fault.empty()) {
    std::cerr << options.tool << ": warning: " << ground_truth << ": " << fault << std::endl;
  }
  return run;
}

}  // namespace

void addRunOptions(CLI::App& app, FailAwareRunOptions& options) {
  options.tool = app.get_name();
  app.add_option("--ground-truth", options.ground_truths,
                 "true poses of a run, KITTI rows, lidar frame; may be repeated, in the order of --run")
      ->required();
  app.add_option("--run", options.runs, "folder that offline_odometry wrote; may be repeated")->required();
  app.add_option("--calib", options.calib, "KITTI calib.txt: the ground truths are in the camera frame");
  app.add_option("--parameters", options.parameters,
                 "yaml file with parameters to replay the monitor with; may be repeated; for a key in several, the "
                 "last one counts")
      ->take_all();
  app.add_option("--set", options.set, "key=value, one such parameter; may be repeated")->take_all();
}

std::vector<FailAwareRun> loadRuns(const FailAwareRunOptions& options) {
  if (options.ground_truths.size() != options.runs.size()) {
    throw InputError(std::to_string(options.ground_truths.size()) + " x --ground-truth, " +
                     std::to_string(options.runs.size()) + " x --run: there must be as many of one as of the other");
  }
  requireEffectOfSet(options);
  std::vector<FailAwareRun> runs;
  for (std::size_t i = 0; i < options.runs.size(); ++i) {
    runs.push_back(loadRun(options.runs[i], options.ground_truths[i], options));
  }
  const auto unused = std::find_if(runs.begin(), runs.end(), [](const auto& run) { return !run.unused_keys.empty(); });
  if (unused != runs.end()) warnOfUnusedKeys(*unused, options);
  return runs;
}

std::vector<FailAwareEpisode> episodesOf(const std::vector<FailAwareRun>& runs, std::size_t index,
                                         const MonitorParameters& monitor, const FailureEpisode::Params& params) {
  const FailAwareRun& run = runs[index];
  std::vector<FailAwareEpisode> episodes = failAwareEpisodes(run.truth, run.log, monitor, params);
  for (FailAwareEpisode& episode : episodes) {
    episode.run = index;
    for (const double begin_s : run.fault_begins_s) episode.fault_begins_s.push_back(begin_s - episode.begin_s);
  }
  return episodes;
}

void addAlertLimitOption(CLI::App& app, std::optional<double>& alert_limit_m) {
  app.add_option("--alert-limit", alert_limit_m,
                 "horizontal error that counts as a failure, m (default: that of the monitor, "
                 "monitor.predictor.alert_limit_m of the runs or of --set)")
      ->check(positiveNumber());
}

double alertLimitOf(const std::vector<FailAwareRun>& runs, const std::optional<double>& given_m) {
  if (given_m) return *given_m;
  const auto limitOf = [](const FailAwareRun& run) { return run.params.profile.monitor.predictor.alert_limit_m; };
  for (const FailAwareRun& run : runs) {
    if (limitOf(run) == limitOf(runs.front())) continue;
    throw InputError(run.name + ": its alert limit is not that of " + runs.front().name + "; say --alert-limit");
  }
  return limitOf(runs.front());
}

}  // namespace fail_aware
