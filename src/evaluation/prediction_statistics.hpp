// How good are times to failure as numbers: late ones, how steady they are, how reliable.
//
// late         a prediction longer than the true remaining time: unsafe. Judged where it can be: in failing episodes,
//              and in the others where the prediction is shorter than what was watched (then it is not late). "Beyond
//              the horizon" is a prediction of the horizon.
// change       from one judged second to the next the prediction changes by more than half of what it was, to
//              and from beyond the horizon, too
// jump         from one judged second to the next the prediction changes by more than half of what was expected
//              (the last one less the time that passed)
// sign change  the deviation from what was expected turns its sign; per minute
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "evaluation/fail_aware_episode.hpp"
#include "fail_aware_lidar_odometry/monitor.hpp"

namespace fail_aware {

/// One prediction at one instant of an episode, in order of time.
struct JudgedPrediction {
  double since_start_s = 0.0;
  double remaining_s = 0.0;
  bool failed = false;  ///< false: the run ended first, at remaining_s
  TimeToFailure predicted;
};

/// The covariance's time at one sweep of an episode.
JudgedPrediction covariancePrediction(const FailAwareEpisode& episode, std::size_t sweep);

struct LateStatistics {
  std::size_t decided = 0;  ///< it is known whether the prediction was late
  std::size_t late = 0;
  std::size_t failing_decided = 0;  ///< of them in failing episodes
  double lateRatio() const;         ///< of all decided
  double lateRatioOfFailing() const;
};

LateStatistics lateStatistics(const std::vector<JudgedPrediction>& predictions);

struct StabilityStatistics {
  double watched_s = 0.0;
  std::size_t steps = 0, changes = 0, jumps = 0, sign_changes = 0;
  double changeRatio() const;
  double jumpRatio() const;
  double signChangesPerMinute() const;
};

/// Of one episode.
StabilityStatistics stabilityOf(const std::vector<JudgedPrediction>& episode);
StabilityStatistics operator+(const StabilityStatistics& a, const StabilityStatistics& b);

/// Of the predictions between two values: how many failed within what was predicted, of those of which it is known.
struct ReliabilityBin {
  double from_s = 0.0, to_s = 0.0;
  std::size_t predictions = 0, decided = 0, failed_within = 0;
  double median_remaining_s = -1.0;  ///< Kaplan and Meier's; -1: fewer than half failed
};

/// `edges_s` increasing; bin i holds edges[i] <= predicted < edges[i + 1], the last one also what lies beyond.
std::vector<ReliabilityBin> reliabilityCurve(const std::vector<JudgedPrediction>& predictions,
                                             const std::vector<double>& edges_s);

}  // namespace fail_aware
