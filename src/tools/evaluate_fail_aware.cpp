// Judges the time to failure against the truth: replays the monitor of recorded runs for a start (t1) every few
// seconds.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "fail_aware_report.hpp"
#include "fail_aware_run.hpp"
#include "json.hpp"
#include "result_files.hpp"
#include "tool_support.hpp"

namespace {

using namespace fail_aware;
namespace fs = std::filesystem;

constexpr const char* kName = "evaluate_fail_aware";

struct Options {
  FailAwareRunOptions runs;
  std::string output;
  FailureEpisode::Params episodes;
  std::optional<double> alert_limit_m;
  ReportOptions report;
};

void addOptions(CLI::App& app, Options& options) {
  addRunOptions(app, options.runs);
  app.add_option("--output", options.output,
                 "folder for fail_aware.json and predictions.csv; plot_fail_aware draws them");
  addAlertLimitOption(app, options.alert_limit_m);
  app.add_option("--episode-every", options.episodes.episode_every_s, "time between starts, s")
      ->check(positiveNumber())
      ->capture_default_str();
  app.add_option("--early", options.report.early_s, "an alarm more than this before a failure is a false one, s")
      ->check(positiveNumber())
      ->capture_default_str();
  app.add_option("--resamples", options.report.resamples, "of the bootstrap")
      ->check(wholeNumber(1, 1000000))
      ->capture_default_str();
  app.add_option("--seed", options.report.seed, "of the bootstrap")->check(wholeNumber(0))->capture_default_str();
}

int run(Options options) {
  const std::vector<FailAwareRun> runs = loadRuns(options.runs);
  options.episodes.alert_limit_m = alertLimitOf(runs, options.alert_limit_m);
  const fs::path folder = options.output;
  if (!folder.empty()) makeResultFolder(folder);

  Json reports;
  std::vector<FailAwareEpisode> all;
  std::vector<const FailAwareRun*> all_runs;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    std::vector<FailAwareEpisode> episodes =
        failAwareEpisodes(runs[r].truth, runs[r].log, runs[r].params.profile.monitor, options.episodes);
    for (FailAwareEpisode& episode : episodes) episode.run = r;
    std::string name = runs[r].name;
    if (reports.contains(name)) name += "#" + std::to_string(r + 1);
    reports[name] = predictionReport(episodes, options.report);
    reports[name]["consistency"] = consistencyReport({&runs[r]}, episodes);
    std::move(episodes.begin(), episodes.end(), std::back_inserter(all));
    all_runs.push_back(&runs[r]);
  }
  if (runs.size() > 1) {
    reports["pooled"] = predictionReport(all, options.report);
    reports["pooled"]["consistency"] = consistencyReport(all_runs, all);
  }
  printTable(std::cout, reports);
  std::cout << std::flush;
  if (!std::cout) throw std::runtime_error("stdout: could not be written");
  if (!folder.empty()) {
    std::ofstream json = createFile(folder / "fail_aware.json");
    json << reports.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
    finishFile(json, folder / "fail_aware.json");
    std::ofstream csv = createFile(folder / "predictions.csv");
    writePredictions(csv, runs, all);
    finishFile(csv, folder / "predictions.csv");
  }
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(kName, [&] {
    CLI::App app(
        "Judges the time to failure of recorded runs against ground truth. The monitor is replayed for a start (t1) "
        "every few seconds; predictions 1, 3, 5 s after t1 and every further second before the failure are compared "
        "with the true remaining time. Prints a table.\nExit codes: 0 done, 1 the work failed, 2 bad usage or input.",
        kName);
    Options options;
    addOptions(app, options);
    if (!parseArguments(app, argc, argv)) return kExitDone;
    return run(options);
  });
}
