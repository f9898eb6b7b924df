// Fits the noise parameters of increments and drift to recorded runs with ground truth: yaml on stdout or in a file.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <string>
#include <variant>
#include <vector>

#include "core/io/input_error.hpp"
#include "evaluation/noise_calibration.hpp"
#include "evaluation/quantile.hpp"
#include "fail_aware_run.hpp"
#include "tool_support.hpp"

namespace {

using namespace fail_aware;

constexpr const char* kName = "calibrate_noise";

struct Options {
  FailAwareRunOptions runs;
  std::string output;
};

constexpr double kLeastRatio = 0.1;
constexpr double kMostError_m = 0.1, kMostErrorRatio = 0.05;  // of a sweep's motion

const std::string kDrift = "monitor.drift.", kIncrement = "filter.increment_";

bool isOfDrift(const std::string& key) { return key.rfind(kDrift, 0) == 0; }
bool isOfIncrement(const std::string& key) { return key.rfind(kIncrement, 0) == 0; }

/// Another drive's truth, or an odometry that was lost, would give values that no vehicle can use.
void requireItsTruth(const FailAwareRun& run, const std::vector<IncrementSample>& increments) {
  std::vector<double> too_large;
  for (const IncrementSample& increment : increments) {
    too_large.push_back(increment.error.head<2>().norm() - kMostError_m - kMostErrorRatio * increment.distance_m);
  }
  if (too_large.empty() || quantile(too_large, 0.5) <= 0.0) return;
  throw InputError(
      run.name +
      ": half of its motions differ from the ground truth by more than 0.1 m and 5 %: it is another drive's, or "
      "the odometry was lost; leave the run out");
}

/// What the drives show next to nothing of stays as it was, and is said: one drive has one bias, and shows no other.
void keepWhatWasNotSeen(const ParameterList& given, ParameterList& fitted) {
  for (std::size_t i = 0; i < fitted.size(); ++i) {
    const auto& [key, before] = given[i];
    if (!isOfDrift(key) || !std::holds_alternative<double>(before)) continue;
    const double before_value = std::get<double>(before), value = std::get<double>(fitted[i].second);
    if (value >= kLeastRatio * before_value) continue;
    std::cerr << kName << ": " << key << " left as it is, " << before_value << ": these drives show " << value
              << ", which is too little to be believed; give more of them, or set it by hand\n";
    fitted[i].second = before_value;
  }
}

int run(const Options& options) {
  const std::vector<FailAwareRun> runs = loadRuns(options.runs);
  std::vector<IncrementSample> increments;
  std::vector<DriftRun> drives;
  ProgressBar progress(runs.size() + 2);  // the runs, and two fits
  progress.update(0);
  for (const FailAwareRun& run : runs) {
    const std::vector<IncrementSample> of_run = incrementSamples(run.truth, run.log, run.made_with);
    requireItsTruth(run, of_run);
    increments.insert(increments.end(), of_run.begin(), of_run.end());
    drives.push_back({run.truth, run.log});
    progress.update(drives.size());
  }
  const ProfileParameters& given = runs.front().params.profile;
  ProfileParameters fitted = given;
  fitted.filter = fitIncrementNoise(increments, fitted.filter);
  for (std::size_t r = 0; r < runs.size(); ++r) {  // as if the runs had been made with it
    const double rescaled = fitted.filter.increment_scale / runs[r].made_with.increment_scale;
    for (MonitorInput& input : drives[r].log) input.state.registration_covariance *= rescaled;
  }
  progress.update(runs.size() + 1);
  fitted.monitor.drift = fitDrift(drives, fitted.monitor.drift);
  progress.update(runs.size() + 2);
  progress.finish();

  ParameterList all = toList(fitted), list;
  keepWhatWasNotSeen(toList(given), all);
  for (const auto& [key, value] : all) {
    if (isOfIncrement(key) || isOfDrift(key)) list.emplace_back(key, value);
  }
  reportFitted(kName, toList(given), list, options.output,
               "fitted to " + std::to_string(increments.size()) + " motions; runs: " + std::to_string(runs.size()));
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(kName, [&] {
    CLI::App app(
        "Fits filter.increment_* and of monitor.drift registration_ratio, position_ and heading_per_root_metre, "
        "heading_bias and scale_bias to recorded runs with ground truth, by (Gaussian) maximum likelihood. The "
        "jitter (transient_*), map_length_m, the tilt and the predictor's "
        "degrees_of_freedom stay as they are: choose them by the "
        "coverage that evaluate_fail_aware shows. Use runs on which the odometry was not lost, and judge the result on "
        "others: evaluate_fail_aware --parameters FILE shows the drift's effect at once; the increments' is seen after "
        "offline_odometry ran anew.\n"
        "Exit codes: 0 done, 1 the work failed, 2 bad usage or input.",
        kName);
    Options options;
    options.runs.used_keys = {kDrift, kIncrement};
    addRunOptions(app, options.runs);
    app.add_option("--output", options.output, "yaml file with the fitted parameters, for --parameters");
    if (!parseArguments(app, argc, argv)) return kExitDone;
    return run(options);
  });
}
