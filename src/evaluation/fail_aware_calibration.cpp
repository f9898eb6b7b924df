#include "evaluation/fail_aware_calibration.hpp"

#include <algorithm>
#include <cmath>

#include "evaluation/alarm_statistics.hpp"
#include "evaluation/kaplan_meier.hpp"
#include "evaluation/prediction_statistics.hpp"
#include "evaluation/quantile.hpp"

namespace fail_aware {

namespace {

constexpr double kLogOddsStep = 0.02;

double logOdds(double confidence) { return std::log(confidence / (1.0 - confidence)); }

/// Halfway between two confidences; nothing if they are near enough.
std::optional<double> between(double smaller, double larger) {
  const double a = logOdds(smaller), b = logOdds(larger);
  if (!(b - a > kLogOddsStep)) return std::nullopt;
  return 1.0 / (1.0 + std::exp(-0.5 * (a + b)));
}

/// Of the predictions of episodes that fail; nothing if none does.
std::optional<double> lateRatio(const std::vector<FailAwareEpisode>& episodes) {
  std::vector<JudgedPrediction> judged;
  for (const FailAwareEpisode& episode : episodes) {
    for (const std::size_t i : judgedSweeps(episode)) {
      if (!episode.isBeforeAFault(i)) judged.push_back(covariancePrediction(episode, i));
    }
  }
  const LateStatistics statistics = lateStatistics(judged);
  if (statistics.failing_decided == 0) return std::nullopt;
  return statistics.lateRatioOfFailing();
}

}  // namespace

std::optional<double> etaThreshold(const std::vector<FailAwareEpisode>& episodes, double failed_by) {
  std::vector<CensoredValue> values;
  for (const FailAwareEpisode& episode : episodes) {
    if (episode.sweeps.empty()) continue;
    const std::size_t end = episode.failed ? episode.sweepsBeforeFailure() : episode.sweeps.size() - 1;
    values.push_back({episode.sweeps[end].output.eta, episode.failed});
  }
  const std::optional<double> threshold = kaplanMeierQuantile(values, failed_by);
  return threshold.value_or(0.0) > 0.0 ? threshold : std::nullopt;
}

std::optional<double> quietEtaThreshold(const std::vector<FailAwareEpisode>& episodes, double passed_by) {
  std::vector<double> values;
  for (const FailAwareEpisode& episode : episodes) {
    if (!episode.failed && !episode.sweeps.empty()) values.push_back(episode.sweeps.back().output.eta);
  }
  if (values.empty()) return std::nullopt;
  const double threshold = quantile(values, 1.0 - passed_by);
  if (!(threshold > 0.0)) return std::nullopt;
  return threshold;
}

std::size_t failuresThatCount(const std::vector<FailAwareEpisode>& episodes) {
  const auto counts = [](const FailAwareEpisode& episode) {
    const std::vector<std::size_t> judged = judgedSweeps(episode);
    return episode.failed &&
           std::any_of(judged.begin(), judged.end(), [&](std::size_t sweep) { return !episode.isBeforeAFault(sweep); });
  };
  return static_cast<std::size_t>(std::count_if(episodes.begin(), episodes.end(), counts));
}

std::optional<double> smallestConfidence(const std::function<bool(double)>& holds, double smallest, double largest) {
  if (holds(smallest)) return smallest;
  if (!holds(largest)) return std::nullopt;
  while (const std::optional<double> middle = between(smallest, largest)) {
    (holds(*middle) ? largest : smallest) = *middle;
  }
  return largest;
}

std::optional<double> confidenceForLateRatio(const std::function<std::vector<FailAwareEpisode>(double)>& episodes_with,
                                             double late_ratio, double smallest, double largest) {
  return smallestConfidence(
      [&](double confidence) {
        const std::optional<double> ratio = lateRatio(episodes_with(confidence));
        return ratio && *ratio <= late_ratio;
      },
      smallest, largest);
}

std::optional<double> confidenceForAlarmRatio(const std::function<std::vector<FailAwareEpisode>(double)>& episodes_with,
                                              double alarm_ratio, double smallest, double largest) {
  const auto soundWith = [&](double confidence) {
    std::vector<FailAwareEpisode> sound;
    for (const FailAwareEpisode& episode : episodes_with(confidence)) {
      if (!episode.failed) sound.push_back(episode);
    }
    return sound;
  };
  const auto isQuiet = [&](const std::vector<FailAwareEpisode>& sound) {
    return alarmStatistics(sound).alarmRatio() <= alarm_ratio;
  };
  const auto quiet = [&](double confidence) { return isQuiet(soundWith(confidence)); };
  const std::vector<FailAwareEpisode> at_largest = soundWith(largest);
  if (at_largest.empty()) return std::nullopt;
  if (isQuiet(at_largest)) return largest;
  if (!quiet(smallest)) return std::nullopt;
  while (const std::optional<double> middle = between(smallest, largest)) {
    (quiet(*middle) ? smallest : largest) = *middle;
  }
  return smallest;
}

}  // namespace fail_aware
