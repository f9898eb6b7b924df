#include "evaluation/prediction_statistics.hpp"

#include <algorithm>
#include <cmath>

#include "evaluation/kaplan_meier.hpp"

namespace fail_aware {

namespace {

constexpr double kJumpRatio = 0.5;
constexpr double kSteady_s = 1e-6;

double ratio(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

bool isDecided(const JudgedPrediction& p) {
  return p.predicted.isKnown() && (p.failed || p.predicted.seconds <= p.remaining_s);
}

bool isLate(const JudgedPrediction& p) { return p.failed && p.predicted.seconds > p.remaining_s; }

// The horizon moves on with time, so what lay beyond it is expected to lie there still.
bool bothBeyond(const TimeToFailure& a, const TimeToFailure& b) {
  return a.status == TimeToFailureStatus::kBeyondHorizon && b.status == TimeToFailureStatus::kBeyondHorizon;
}

}  // namespace

JudgedPrediction covariancePrediction(const FailAwareEpisode& episode, std::size_t sweep) {
  const FailAwareSweep& s = episode.sweeps[sweep];
  return {s.since_start_s, s.remaining_s, episode.failed, s.output.time_to_failure_covariance};
}

double LateStatistics::lateRatio() const { return ratio(static_cast<double>(late), static_cast<double>(decided)); }

double LateStatistics::lateRatioOfFailing() const {
  return ratio(static_cast<double>(late), static_cast<double>(failing_decided));
}

LateStatistics lateStatistics(const std::vector<JudgedPrediction>& predictions) {
  LateStatistics statistics;
  for (const JudgedPrediction& p : predictions) {
    if (!isDecided(p)) continue;
    ++statistics.decided;
    if (p.failed) ++statistics.failing_decided;
    if (isLate(p)) ++statistics.late;
  }
  return statistics;
}

double StabilityStatistics::changeRatio() const {
  return ratio(static_cast<double>(changes), static_cast<double>(steps));
}

double StabilityStatistics::jumpRatio() const { return ratio(static_cast<double>(jumps), static_cast<double>(steps)); }

double StabilityStatistics::signChangesPerMinute() const {
  return ratio(60.0 * static_cast<double>(sign_changes), watched_s);
}

StabilityStatistics stabilityOf(const std::vector<JudgedPrediction>& episode) {
  StabilityStatistics statistics;
  double last_deviation_s = 0.0;
  for (std::size_t i = 1; i < episode.size(); ++i) {
    const JudgedPrediction &before = episode[i - 1], &now = episode[i];
    const double passed_s = now.since_start_s - before.since_start_s;
    statistics.watched_s += passed_s;
    if (!before.predicted.isKnown() || !now.predicted.isKnown()) continue;
    ++statistics.steps;
    const double change_s = std::abs(now.predicted.seconds - before.predicted.seconds);
    if (change_s > std::max(kSteady_s, kJumpRatio * before.predicted.seconds)) ++statistics.changes;
    if (bothBeyond(before.predicted, now.predicted)) continue;
    const double expected_s = std::max(0.0, before.predicted.seconds - passed_s);
    const double deviation_s = now.predicted.seconds - expected_s;
    if (std::abs(deviation_s) <= kSteady_s) continue;
    if (std::abs(deviation_s) > kJumpRatio * expected_s) ++statistics.jumps;
    if (deviation_s * last_deviation_s < 0.0) ++statistics.sign_changes;
    last_deviation_s = deviation_s;
  }
  return statistics;
}

StabilityStatistics operator+(const StabilityStatistics& a, const StabilityStatistics& b) {
  return {a.watched_s + b.watched_s, a.steps + b.steps, a.changes + b.changes, a.jumps + b.jumps,
          a.sign_changes + b.sign_changes};
}

std::vector<ReliabilityBin> reliabilityCurve(const std::vector<JudgedPrediction>& predictions,
                                             const std::vector<double>& edges_s) {
  std::vector<ReliabilityBin> bins;
  for (std::size_t b = 0; b + 1 < edges_s.size(); ++b) {
    const bool last = b + 2 == edges_s.size();
    ReliabilityBin bin;
    bin.from_s = edges_s[b];
    bin.to_s = edges_s[b + 1];
    std::vector<CensoredValue> remaining;
    for (const JudgedPrediction& p : predictions) {
      const bool inside =
          p.predicted.isKnown() && p.predicted.seconds >= bin.from_s && (last || p.predicted.seconds < bin.to_s);
      if (!inside) continue;
      ++bin.predictions;
      remaining.push_back({p.remaining_s, p.failed});
      if (!isDecided(p)) continue;
      ++bin.decided;
      if (isLate(p)) ++bin.failed_within;
    }
    bin.median_remaining_s = kaplanMeierQuantile(remaining, 0.5).value_or(-1.0);
    bins.push_back(bin);
  }
  return bins;
}

}  // namespace fail_aware
