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

#include "evaluation/conformal_risk.hpp"
#include "evaluation/fail_aware_calibration.hpp"
#include "fail_aware_run.hpp"
#include "tool_support.hpp"

namespace {

using namespace fail_aware;

constexpr const char* kName = "calibrate_fail_aware";
constexpr const char* kConfidence = "monitor.predictor.confidence";
constexpr double kSmallestAlarmConfidence = 0.3;
constexpr double kSmallestLateRatio = 0.05;
constexpr std::size_t kMostReplays = 37;  // as the runs are, and a dozen for each of three fits

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

/// The parameters one after the other: each is fitted with those before it.
class Calibration {
 public:
  explicit Calibration(const Options& options)
      : options_(options),
        runs_(loadRuns(options.runs)),
        given_(runs_.front().params.profile.monitor.predictor),
        progress_(kMostReplays * runs_.size()) {
    options_.episodes.alert_limit_m = alertLimitOf(runs_, options.alert_limit_m);
    progress_.update(0);
    as_is_ = replay([](MonitorParameters&) {});
    failed_ = std::count_if(as_is_.begin(), as_is_.end(), [](const FailAwareEpisode& e) { return e.failed; });
  }

  void fitThreshold() {
    if (options_.eta_failed_by) {
      threshold_ = add("monitor.indicator.threshold", etaThreshold(as_is_, *options_.eta_failed_by),
                       "too few failures, or they come before eta grows");
    } else if (failed_ == 0) {
      add("monitor.indicator.threshold", std::nullopt, "no start fails, so nothing shows what eta is at a failure");
    } else {
      threshold_ = add("monitor.indicator.threshold", quietEtaThreshold(as_is_, options_.eta_passed_by),
                       "every episode failed, or eta did not grow");
    }
  }

  void fitConfidence() {
    // the alarm confidence is fitted after it: the smallest gives the longest times
    const double alarm = options_.guarantee ? kSmallestAlarmConfidence : given_.alarm_confidence;
    const auto withConfidence = [&](double tried) { return withConfidences(tried, alarm); };
    const double late_ratio = options_.late_ratio;
    const std::size_t count = failuresThatCount(as_is_);
    if (options_.guarantee) {
      confidence_ = confidenceWithGuarantee(as_is_, withConfidence, late_ratio);
      if (confidence_) list_.emplace_back(kConfidence, *confidence_);
      for (std::string& note :
           confidenceNotes(late_ratio, confidence_.has_value(),
                           lateRiskByState(as_is_, confidence_ ? withConfidence(*confidence_) : as_is_))) {
        notes_.push_back(std::move(note));
      }
    } else if (count > 0 && count < startsNeeded(late_ratio)) {
      notes_.push_back(kConfidence + std::string(" left as it is: ") + fewFailures(count, late_ratio));
    } else {
      const char* why_not = failed_ == 0 ? "no start fails: give runs that do"
                            : count == 0 ? "starts fail only after a fault, and those do not count: give others that do"
                                         : "predictions are late whatever it is: calibrate_noise first";
      confidence_ = add(kConfidence, confidenceForLateRatio(withConfidence, late_ratio), why_not);
    }
  }

  // The alarm confidence is at most the confidence: the state must not act on a probability of failure that is smaller
  // than the one that the published time already bears.
  void fitAlarmConfidence() {
    const double largest = confidence_.value_or(given_.confidence);
    const auto withAlarm = [&](double tried) {
      return replay([&](MonitorParameters& m) {
        if (threshold_) m.indicator.threshold = *threshold_;
        m.predictor.confidence = largest;
        m.predictor.alarm_confidence = tried;
      });
    };
    std::optional<double> alarm =
        confidenceForAlarmRatio(withAlarm, options_.alarm_ratio, std::min(kSmallestAlarmConfidence, largest), largest);
    if (!alarm && given_.alarm_confidence > largest) {
      alarm = largest;
      notes_.push_back(
          "monitor.predictor.alarm_confidence lowered to the confidence, which bounds it; the alarm is up too long "
          "whatever it is");
    }
    const bool all_failed = failed_ == static_cast<std::ptrdiff_t>(as_is_.size());
    add("monitor.predictor.alarm_confidence", alarm,
        all_failed ? "every start fails" : "the alarm is up too long whatever it is");
    if (alarm && confidence_ && !options_.guarantee && *alarm < given_.alarm_confidence) refitConfidence(*alarm);
  }

  int report() {
    progress_.update(kMostReplays * runs_.size());  // most bisections end before
    progress_.finish();
    for (const std::string& note : notes_) std::cerr << kName << ": " << note << '\n';
    if (list_.empty()) return reportError(kName, "nothing could be fitted: give more runs", kExitFailed);
    reportFitted(kName, toList(runs_.front().params.profile), list_, options_.output,
                 counted(list_.size(), "parameter") + " fitted to " + counted(as_is_.size(), "start") + ", " +
                     std::to_string(failed_) + " of which fail");
    return kExitDone;
  }

 private:
  /// A smaller alarm confidence makes times longer, and more of them late.
  void refitConfidence(double alarm) {
    const auto withConfidence = [&](double tried) { return withConfidences(tried, alarm); };
    const std::optional<double> refitted = confidenceForLateRatio(withConfidence, options_.late_ratio, *confidence_);
    if (!refitted) {
      notes_.push_back("with this alarm_confidence more predictions are late than --late whatever the confidence is");
    } else if (*refitted != *confidence_) {
      notes_.push_back(kConfidence + std::string(" fitted again, with the new alarm_confidence"));
      for (auto& [key, value] : list_) {
        if (key == kConfidence) value = *refitted;
      }
    }
  }

  /// The alarm confidence is at most the confidence.
  std::vector<FailAwareEpisode> withConfidences(double confidence, double alarm) {
    return replay([&](MonitorParameters& m) {
      m.predictor.confidence = confidence;
      m.predictor.alarm_confidence = std::min(alarm, confidence);
    });
  }

  /// All starts of all runs, with parameters that `change` has changed.
  template <class Change>
  std::vector<FailAwareEpisode> replay(const Change& change) {
    std::vector<FailAwareEpisode> all;
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      MonitorParameters monitor = runs_[r].params.profile.monitor;
      change(monitor);
      std::vector<FailAwareEpisode> episodes = episodesOf(runs_, r, monitor, options_.episodes);
      std::move(episodes.begin(), episodes.end(), std::back_inserter(all));
    }
    progress_.update(replayed_ += runs_.size());
    return all;
  }

  std::optional<double> add(const char* key, const std::optional<double>& value, const char* why_not) {
    if (value) list_.emplace_back(key, *value);
    if (!value) notes_.push_back(key + std::string(" left as it is: ") + why_not);
    return value;
  }

  Options options_;
  std::vector<FailAwareRun> runs_;
  CovariancePredictor::Params given_;  ///< of the first run
  ProgressBar progress_;
  std::size_t replayed_ = 0;
  std::vector<FailAwareEpisode> as_is_;
  std::ptrdiff_t failed_ = 0;  ///< of as_is_
  std::optional<double> threshold_, confidence_;
  ParameterList list_;
  std::vector<std::string> notes_;
};

int run(const Options& options) {
  if (options.guarantee && !(options.late_ratio > 0.0)) {
    return reportError(kName, "no number of runs guarantees --late 0: give a larger ratio", kExitUsage);
  }
  Calibration calibration(options);
  calibration.fitThreshold();
  calibration.fitConfidence();
  calibration.fitAlarmConfidence();
  return calibration.report();
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
