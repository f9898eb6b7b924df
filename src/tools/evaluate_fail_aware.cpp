// Judges the time to failure against the truth: replays the monitor of recorded runs for a start (t1) every few
// seconds.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "episode_file.hpp"
#include "fail_aware_report.hpp"
#include "fail_aware_run.hpp"
#include "fail_aware_table.hpp"
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
  std::vector<std::string> kept;  ///< files of episodes, in place of the runs
  bool keep_episodes = false;
  FailureEpisode::Params episodes;
  std::optional<double> alert_limit_m;
  ReportOptions report;
};

void addOptions(CLI::App& app, Options& options) {
  addRunOptions(app, options.runs);
  CLI::Option* run = app.get_option("--run")->required(false);
  app.get_option("--ground-truth")->required(false);
  CLI::Option* output =
      app.add_option("--output", options.output,
                     "folder for fail_aware.json, predictions.csv and episodes.csv; plot_fail_aware draws them");
  app.add_flag("--keep-episodes", options.keep_episodes, "write episodes.bin, too: for --episodes")->needs(output);
  app.add_option("--episodes", options.kept,
                 "in place of --run: episodes.bin of runs that were judged before, to judge them together; may be "
                 "repeated. The figures are those over all the runs at once, in the order of the files")
      ->take_all()
      ->excludes(run);
  addAlertLimitOption(app, options.alert_limit_m);
  app.add_option("--episode-every", options.episodes.episode_every_s, "time between starts, s")
      ->check(positiveNumber())
      ->capture_default_str();
  for (const char* of_runs : {"--ground-truth", "--calib", "--parameters", "--set", "--alert-limit", "--episode-every"})
    app.get_option(of_runs)->excludes(app.get_option("--episodes"));
  app.add_option("--early", options.report.early_s, "an alarm more than this before a failure is a false one, s")
      ->check(positiveNumber())
      ->capture_default_str();
  app.add_option("--deceleration", options.report.deceleration_mps2, "of the planner's stop, m/s^2")
      ->check(positiveNumber())
      ->capture_default_str();
  app.add_option("--resamples", options.report.resamples, "of the bootstrap")
      ->transform(wholeNumber(1, 1000000))
      ->capture_default_str();
  app.add_option("--seed", options.report.seed, "of the bootstrap")->transform(wholeNumber(0))->capture_default_str();
}

std::vector<JudgedRun> judgeRuns(Options& options) {
  const std::vector<FailAwareRun> runs = loadRuns(options.runs);
  options.episodes.alert_limit_m = alertLimitOf(runs, options.alert_limit_m);
  std::vector<JudgedRun> judged;
  ProgressBar progress(runs.size());
  progress.update(0);  // a long run takes minutes
  for (std::size_t r = 0; r < runs.size(); ++r) {
    judged.push_back({runs[r].name, options.episodes.alert_limit_m, options.episodes.episode_every_s,
                      consistencySamples(runs[r]),
                      episodesOf(runs, r, runs[r].params.profile.monitor, options.episodes)});
    progress.update(judged.size());
  }
  return judged;
}

std::vector<JudgedRun> readJudgedRuns(const std::vector<std::string>& files) {
  std::vector<JudgedRun> all;
  std::set<std::string> known;
  for (const std::string& file : files) {
    if (!known.insert(fs::weakly_canonical(file).string()).second) throw InputError(file + ": given twice");
    std::vector<JudgedRun> runs = readEpisodeFile(file);
    for (JudgedRun& run : runs) {
      if (!all.empty() &&
          (run.alert_limit_m != all.front().alert_limit_m || run.episode_every_s != all.front().episode_every_s)) {
        throw InputError(file + ": judged with another --alert-limit or --episode-every than " + files.front());
      }
      all.push_back(std::move(run));
    }
  }
  return all;
}

/// "16 starts, 7 fail; missed 14.3 %, concordance 0.829"; what does not exist for these runs is left out.
std::string verdict(const Json& report) {
  std::string text = counted(report["episodes"].get<std::size_t>(), "start") + ", " +
                     std::to_string(report["failing"].get<std::size_t>()) + " fail";
  if (report["episodes"] == 0) return text + ": the run is too short, or no motion was observed in it";
  char number[48];
  if (report["missed_ratio"].is_number()) {
    std::snprintf(number, sizeof(number), "; missed %.1f %%", 100.0 * report["missed_ratio"].get<double>());
    text += number;
  }
  const Json& concordance = report["concordance"]["combination"]["index"];
  if (concordance.is_number()) {
    std::snprintf(number, sizeof(number), "; concordance %.3f", concordance.get<double>());
    text += number;
  }
  return text;
}

int run(Options options) {
  if (options.kept.empty() && options.runs.runs.empty() && options.runs.ground_truths.empty()) {
    throw InputError("--ground-truth and --run, or --episodes, are needed (see --help)");
  }
  std::vector<JudgedRun> runs = options.kept.empty() ? judgeRuns(options) : readJudgedRuns(options.kept);
  const fs::path folder = options.output;
  if (!folder.empty()) makeResultFolder(folder);
  if (options.keep_episodes) writeEpisodeFile(folder / "episodes.bin", runs);

  const char* const kPooled = "pooled";
  Json reports;
  std::vector<FailAwareEpisode> all;
  std::vector<const ConsistencySamples*> all_samples;
  std::vector<std::string> names;  // as cells
  ProgressBar progress(runs.size() + 1);
  progress.update(0);
  for (std::size_t r = 0; r < runs.size(); ++r) {
    std::vector<FailAwareEpisode>& episodes = runs[r].episodes;
    for (FailAwareEpisode& episode : episodes) episode.run = r;
    std::string name = runs[r].name;
    for (std::size_t n = r + 1; reports.contains(name) || name == kPooled; ++n) {
      name = runs[r].name + "#" + std::to_string(n);
    }
    reports[name] = predictionReport(episodes, options.report);
    reports[name]["planner"] = plannerReport(episodes, options.report);
    reports[name]["consistency"] = consistencyReport({&runs[r].samples}, episodes);
    std::move(episodes.begin(), episodes.end(), std::back_inserter(all));
    all_samples.push_back(&runs[r].samples);
    names.push_back(csvCell(name));
    progress.update(r + 1);
  }
  if (runs.size() > 1) {
    reports[kPooled] = predictionReport(all, options.report);
    reports[kPooled]["planner"] = plannerReport(all, options.report);
    reports[kPooled]["consistency"] = consistencyReport(all_samples, all);
  }
  progress.update(runs.size() + 1);
  progress.finish();
  printTable(std::cout, reports);
  std::cout << std::flush;
  if (!std::cout) throw std::runtime_error("stdout: could not be written");
  if (!folder.empty()) {
    writeText(folder / "fail_aware.json", reports.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
    std::ofstream csv = createFile(folder / "predictions.csv");
    writePredictions(csv, names, all);
    finishFile(csv, folder / "predictions.csv");
    std::ofstream table = createFile(folder / "episodes.csv");
    writeEpisodes(table, names, all, options.report.early_s);
    finishFile(table, folder / "episodes.csv");
  }
  reportVerdict(kName, verdict(runs.size() > 1 ? reports[kPooled] : reports.front()),
                folder.empty() ? "the same with --output DIR, for plot_fail_aware"
                               : callOf("plot_fail_aware") + " " + options.output);
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
