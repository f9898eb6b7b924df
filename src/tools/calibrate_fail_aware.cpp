// Fits eta's threshold and the predictor's confidences to recorded runs with ground truth: yaml on stdout or in a file.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <iterator>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/parameters/yaml_parameters.hpp"
#include "evaluation/conformal_risk.hpp"
#include "evaluation/fail_aware_calibration.hpp"
#include "fail_aware_run.hpp"
#include "result_files.hpp"
#include "tool_support.hpp"

namespace {

using namespace fail_aware;

constexpr const char* kName = "calibrate_fail_aware";
constexpr const char* kConfidence = "monitor.predictor.confidence";
constexpr double kSmallestAlarmConfidence = 0.3;
constexpr double kSmallestLateRatio = 0.05;
constexpr std::size_t kMostReplays =
    25;  // as the runs are, and a dozen for each confidence: see fail_aware_calibration

struct Options {
  FailAwareRunOptions runs;
  std::string output;
  FailureEpisode::Params episodes;
  std::optional<double> alert_limit_m;
  std::optional<double> eta_failed_by;
  double eta_passed_by = 0.05;
  double late_ratio = 0.1;
  bool guarantee = false;
  double alarm_ratio = 0.05;
};

template <class Change>
std::vector<FailAwareEpisode> allEpisodes(const std::vector<FailAwareRun>& runs, const FailureEpisode::Params& params,
                                          Change&& change) {
  std::vector<FailAwareEpisode> all;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    MonitorParameters monitor = runs[r].params.profile.monitor;
    change(monitor);
    std::vector<FailAwareEpisode> episodes = episodesOf(runs, r, monitor, params);
    std::move(episodes.begin(), episodes.end(), std::back_inserter(all));
  }
  return all;
}

/// What the confidence guarantees, or why it is missing.
std::vector<std::string> confidenceNotes(double late_ratio, bool fitted, const std::vector<LateRisk>& risks) {
  std::vector<std::string> notes;
  const std::size_t needed = drivesToGuarantee(late_ratio);
  const bool too_few =
      std::any_of(risks.begin(), risks.end(), [&](const LateRisk& risk) { return risk.drives < needed; });
  const std::string left = kConfidence + std::string(" left as it is: ");
  if (fitted) {
    notes.push_back("on a further run that fails at most the ratio --late of the predictions is expected to be late");
  } else if (too_few) {
    notes.push_back(left + "the guarantee needs " + std::to_string(needed) +
                    " runs that fail in each state; give more runs, or a larger --late");
  } else {
    notes.push_back(left + "too many runs are late whatever it is; calibrate_noise first, or give a larger --late");
  }
  for (const LateRisk& risk : risks) {
    std::ostringstream text;
    text << std::fixed << std::setprecision(1) << toString(risk.state) << ": " << risk.drives << " runs that fail";
    if (risk.drives > 0)
      text << ", of whose predictions " << 100.0 * risk.mean_loss << " % are late (mean over the runs)";
    notes.push_back(text.str());
  }
  return notes;
}

/// With fewer the ratio of late ones is hardly known: one failure would loosen the confidence for all drives.
std::size_t startsNeeded(double late_ratio) {
  return static_cast<std::size_t>(std::ceil(1.0 / std::max(late_ratio, kSmallestLateRatio)));
}

std::string fewFailures(std::size_t failed, double late_ratio) {
  std::ostringstream text;
  text << failed << (failed == 1 ? " start fails" : " starts fail") << "; --late " << late_ratio << " needs "
       << startsNeeded(late_ratio) << ": give more runs that fail";
  return text.str();
}

int run(Options options) {
  if (options.guarantee && !(options.late_ratio > 0.0)) {
    return reportError(kName, "no number of runs guarantees --late 0: give a larger ratio", kExitUsage);
  }
  requireMonitorKeys(options.runs);
  const std::vector<FailAwareRun> runs = loadRuns(options.runs);
  options.episodes.alert_limit_m = alertLimitOf(runs, options.alert_limit_m);
  ParameterList list;
  std::vector<std::string> notes;
  ProgressBar progress(kMostReplays * runs.size());
  progress.update(0);
  std::size_t replayed = 0;
  const auto replay = [&](const auto& change) {
    std::vector<FailAwareEpisode> episodes = allEpisodes(runs, options.episodes, change);
    progress.update(replayed += runs.size());
    return episodes;
  };
  const auto add = [&](const char* key, const std::optional<double>& value, const char* why_not) {
    if (value) list.emplace_back(key, *value);
    if (!value) notes.push_back(key + std::string(" left as it is: ") + why_not);
    return value;
  };
  const std::vector<FailAwareEpisode> as_is = replay([](MonitorParameters&) {});
  const std::size_t count = failuresThatCount(as_is);
  const auto failed = static_cast<std::size_t>(
      std::count_if(as_is.begin(), as_is.end(), [](const FailAwareEpisode& episode) { return episode.failed; }));
  const std::optional<double> threshold = add("monitor.indicator.threshold",
                                              options.eta_failed_by ? etaThreshold(as_is, *options.eta_failed_by)
                                                                    : quietEtaThreshold(as_is, options.eta_passed_by),
                                              options.eta_failed_by ? "too few failures, or they come before eta grows"
                                                                    : "every episode failed, or eta did not grow");
  const auto withConfidence = [&](double tried) {
    return replay([&](MonitorParameters& m) {
      m.predictor.confidence = tried;
      // the alarm confidence is fitted after it: the smallest gives the longest times
      const double alarm = options.guarantee ? kSmallestAlarmConfidence : m.predictor.alarm_confidence;
      m.predictor.alarm_confidence = std::min(alarm, tried);
    });
  };
  std::optional<double> confidence;
  if (options.guarantee) {
    confidence = confidenceWithGuarantee(as_is, withConfidence, options.late_ratio);
    if (confidence) list.emplace_back(kConfidence, *confidence);
    for (std::string& note :
         confidenceNotes(options.late_ratio, confidence.has_value(),
                         lateRiskByState(as_is, confidence ? withConfidence(*confidence) : as_is))) {
      notes.push_back(std::move(note));
    }
  } else if (count > 0 && count < startsNeeded(options.late_ratio)) {
    notes.push_back(kConfidence + std::string(" left as it is: ") + fewFailures(count, options.late_ratio));
  } else {
    confidence = add(kConfidence, confidenceForLateRatio(withConfidence, options.late_ratio),
                     "no run fails, or only after a fault (give some that do), or predictions are late whatever it is "
                     "(calibrate_noise first)");
  }
  // The alarm confidence is at most the confidence: the state must not act on a probability of failure that is smaller
  // than the one that the published time already bears.
  const CovariancePredictor::Params& given = runs.front().params.profile.monitor.predictor;
  const double largest = confidence.value_or(given.confidence);
  std::optional<double> alarm = confidenceForAlarmRatio(
      [&](double tried) {
        return replay([&](MonitorParameters& m) {
          if (threshold) m.indicator.threshold = *threshold;
          m.predictor.confidence = largest;
          m.predictor.alarm_confidence = tried;
        });
      },
      options.alarm_ratio, std::min(kSmallestAlarmConfidence, largest), largest);
  if (!alarm && given.alarm_confidence > largest) {
    alarm = largest;
    notes.push_back(
        "monitor.predictor.alarm_confidence lowered to the confidence, which bounds it; the alarm is up too long "
        "whatever it is");
  }
  add("monitor.predictor.alarm_confidence", alarm, "every episode failed, or the alarm is up too long whatever it is");
  progress.update(kMostReplays * runs.size());  // most bisections end before
  progress.finish();
  for (const std::string& note : notes) std::cerr << kName << ": " << note << '\n';
  if (list.empty()) return reportError(kName, "nothing could be fitted: give more runs", kExitFailed);
  printAndKeep(formatYaml(list), options.output);
  reportVerdict(kName,
                std::to_string(list.size()) + " parameters fitted to " + std::to_string(as_is.size()) + " starts, " +
                    std::to_string(failed) + " of which fail",
                "judge it on other runs: evaluate_fail_aware --parameters " +
                    (options.output.empty() ? "FILE (--output FILE keeps it)" : options.output));
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(kName, [&] {
    CLI::App app(
        "Fits monitor.indicator.threshold (eta), monitor.predictor.confidence and alarm_confidence to recorded runs "
        "with ground truth; alarm_confidence is at most confidence. Judge the result on other runs: "
        "evaluate_fail_aware --parameters FILE.\n"
        "Exit codes: 0 done, 1 nothing could be fitted, 2 bad usage or input.",
        kName);
    Options options;
    addRunOptions(app, options.runs);
    app.add_option("--output", options.output, "yaml file with the fitted parameters, for --parameters");
    addAlertLimitOption(app, options.alert_limit_m);
    app.add_option("--episode-every", options.episodes.episode_every_s, "time between starts, s")
        ->check(positiveNumber())
        ->capture_default_str();
    app.add_option("--eta-passed-by", options.eta_passed_by,
                   "ratio of the episodes without a failure that may pass eta's threshold")
        ->check(realNumber(0.0, 1.0))
        ->capture_default_str();
    app.add_option("--eta-failed-by", options.eta_failed_by,
                   "instead: ratio of the episodes that failed by eta's threshold (0.5: the article's meaning)")
        ->check(realNumber(0.0, 1.0));
    app.add_option("--late", options.late_ratio, "ratio of late predictions that is borne")
        ->check(realNumber(0.0, 1.0))
        ->capture_default_str();
    app.add_flag("--guarantee", options.guarantee,
                 "choose the confidence so that --late is expected to hold on a further run of the same kind that "
                 "fails, in each state of the present parameters (conformal risk control); needs at least 1 / late - 1 "
                 "runs that fail in each state");
    app.add_option("--alarm", options.alarm_ratio, "ratio of the time without a failure that the alarm may be up")
        ->check(realNumber(0.0, 1.0))
        ->capture_default_str();
    if (!parseArguments(app, argc, argv)) return kExitDone;
    return run(options);
  });
}
