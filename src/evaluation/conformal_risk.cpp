#include "evaluation/conformal_risk.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "evaluation/prediction_statistics.hpp"

namespace fail_aware {

namespace {

constexpr FailAwareState kStates[] = {FailAwareState::kOk, FailAwareState::kDegraded, FailAwareState::kFailing};

/// Of the judged predictions of each run's failing episodes for which the monitor gave this state before.
std::map<std::size_t, std::vector<JudgedPrediction>> predictionsOfRuns(const std::vector<FailAwareEpisode>& before,
                                                                       const std::vector<FailAwareEpisode>& episodes,
                                                                       FailAwareState state) {
  std::map<std::size_t, std::vector<JudgedPrediction>> of_run;
  for (std::size_t e = 0; e < episodes.size(); ++e) {
    if (!episodes[e].failed) continue;
    for (const std::size_t i : judgedSweeps(episodes[e])) {
      if (before[e].sweeps[i].output.state != state || episodes[e].isBeforeAFault(i)) continue;
      of_run[episodes[e].run].push_back(covariancePrediction(episodes[e], i));
    }
  }
  return of_run;
}

}  // namespace

double LateRisk::criterion() const {
  const auto n = static_cast<double>(drives);
  return (n * mean_loss + 1.0) / (n + 1.0);
}

std::vector<LateRisk> lateRiskByState(const std::vector<FailAwareEpisode>& before,
                                      const std::vector<FailAwareEpisode>& episodes) {
  if (before.size() != episodes.size()) throw std::invalid_argument("lateRiskByState: not the same episodes");
  std::vector<LateRisk> risks;
  for (const FailAwareState state : kStates) {
    LateRisk risk;
    risk.state = state;
    double losses = 0.0;
    for (const auto& [run, predictions] : predictionsOfRuns(before, episodes, state)) {
      losses += static_cast<double>(lateStatistics(predictions).late) / static_cast<double>(predictions.size());
      ++risk.drives;
    }
    if (risk.drives > 0) risk.mean_loss = losses / static_cast<double>(risk.drives);
    risks.push_back(risk);
  }
  return risks;
}

std::size_t drivesToGuarantee(double late_ratio) {
  constexpr double kRounding = 1e-9, kMost = 1e9;
  return static_cast<std::size_t>(std::clamp(std::ceil(1.0 / late_ratio - 1.0 - kRounding), 0.0, kMost));
}

std::optional<double> confidenceWithGuarantee(const std::vector<FailAwareEpisode>& before,
                                              const std::function<std::vector<FailAwareEpisode>(double)>& episodes_with,
                                              double late_ratio, double smallest, double largest) {
  return smallestConfidence(
      [&](double confidence) {
        const std::vector<LateRisk> risks = lateRiskByState(before, episodes_with(confidence));
        return std::all_of(risks.begin(), risks.end(),
                           [&](const LateRisk& risk) { return risk.criterion() <= late_ratio; });
      },
      smallest, largest);
}

}  // namespace fail_aware
