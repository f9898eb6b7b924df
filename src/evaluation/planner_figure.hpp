// The planner's figure: the result for a planner that obeys the time to failure, compared with a fixed time or
// distance.
//
// The planner looks once a second, from 3 s after t1 on. A stop from speed v takes max(1 s, v / deceleration).
//   stop rule   the stop begins in the first second in which the time to failure is no longer than the stop takes, or
//               the state is FAILING, FAILED or UNKNOWN (StopRule::kTimeOrState; or only one of the two)
//   stoppable   a failure that comes at least 3 s + the stop at 3 s after t1: a perfect predictor stops in time
//   in time     the stop begins and ends before the failure
//   told        an unstoppable failure at which the planner begins to stop at its first look; for a failure before that
//               look: the state, or a time of 1 s or less, demands the stop in the last second before it
//   used        time driven before the stop begins, divided by the time that a perfect predictor drives: until the
//               failure minus the stop, or the whole drive where no failure comes (a sound drive)
// Baselines: the stop begins after a fixed time, or a fixed distance, since t1. The best of each is chosen in
// hindsight: of those that are in time at least as often as the planner the one with the most time used; if none is,
// the one that is in time most often.
//
// Faults: a failure is not stoppable if the stop, from the speed at the fault, does not fit between a fault that begins
// after t1 and the failure.
// Where the begins of the faults are known, such failures count apart (too_sudden) and nowhere else.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/fail_aware_episode.hpp"

namespace fail_aware {

/// What the planner sees in one second, with the truth.
struct PlannerSecond {
  double since_start_s = 0.0;
  TimeToFailure time_to_failure;
  FailAwareState state = FailAwareState::kUnknown;
  double speed_mps = 0.0;
};

struct PlannerDrive {
  std::vector<PlannerSecond> seconds;
  double time_s = 0.0;  ///< to the failure, or to the end
  bool failed = false;
  std::vector<double> faults_s;  ///< begins of faults, since t1
};

/// Of an episode: the sweeps that its predictions are written for, one a second (eachSecond()).
PlannerDrive plannerDrive(const FailAwareEpisode& episode);

enum class StopRule { kTimeOrState, kState, kTime };

struct PlannerFigure {
  std::size_t stoppable = 0, in_time = 0, unstoppable = 0, told = 0, too_sudden = 0;
  std::size_t sound = 0, sound_stopped = 0;
  double used_failing_s = 0.0, possible_failing_s = 0.0;  ///< of the stoppable failures
  double used_sound_s = 0.0, possible_sound_s = 0.0;

  /// Nothing without a whole to divide by.
  std::optional<double> usedRatio() const;  ///< of both kinds of drives
  std::optional<double> usedRatioOfFailing() const;
  std::optional<double> usedRatioOfSound() const;
};

PlannerFigure plannerFigure(const std::vector<PlannerDrive>& drives, double deceleration_mps2,
                            StopRule rule = StopRule::kTimeOrState);

struct FixedRule {
  double value = 0.0;  ///< s or m since t1
  PlannerFigure figure;
};
FixedRule bestFixedTime(const std::vector<PlannerDrive>& drives, double deceleration_mps2, std::size_t in_time);
FixedRule bestFixedDistance(const std::vector<PlannerDrive>& drives, double deceleration_mps2, std::size_t in_time);

}  // namespace fail_aware
