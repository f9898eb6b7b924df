// A start of the redundancy (t1) together with all that the monitor said after it and what was true: the raw material
// of every figure about the time to failure.
//
// The monitor is replayed for each t1 over the run's log (integrity/monitor_replay.hpp). Poses are of the centre of
// gravity; failure as in evaluation/time_to_failure.hpp: horizontal error relative to the pose at t1 over the limit.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/integrity/monitor.hpp"
#include "core/integrity/silence.hpp"
#include "core/types/monitor_input.hpp"
#include "evaluation/time_to_failure.hpp"
#include "fail_aware_lidar_odometry/monitor.hpp"

namespace fail_aware {

struct FailAwareSweep {
  double since_start_s = 0.0;
  double remaining_s = 0.0;  ///< to the failure or, in an episode without one, to the run's end; < 0 after the failure
  double distance_m = 0.0;   ///< driven since t1, by the estimate
  double speed_mps = 0.0;    ///< the estimate's
  Eigen::Vector2d error_m = Eigen::Vector2d::Zero();  ///< truth - estimate, in the frame at t1
  MonitorOutput output;
  double silent_s = 0.0;  ///< at the end of the time to the next sweep: as long as the live monitor says FAILED, STALE
};

struct FailAwareEpisode {
  std::size_t run = 0;  ///< of which recorded run: set by the caller
  double begin_s = 0.0;
  bool failed = false;
  double time_s = 0.0;  ///< to the failure, or to the run's end
  double alert_limit_m = 0.0;
  std::vector<double> fault_begins_s;  ///< since t1, of faults that were put into the drive: set by the caller
  std::vector<FailAwareSweep> sweeps;  ///< from t1 (the first has since_start_s = 0) to the run's end

  /// What a planner could have acted on: t1 included, the failing sweep not.
  std::size_t sweepsBeforeFailure() const;

  /// Whether a fault that was put into the drive begins after this sweep and before the failure. No prediction can know
  /// it.
  bool isBeforeAFault(std::size_t sweep) const;
};

/// t1: the first sweep whose motion is observed, at or after each begin of FailureEpisode's; the same one once only.
/// `truth[i]`: the pose (cog) at `log[i]`. Throws InputError, ParameterError.
std::vector<FailAwareEpisode> failAwareEpisodes(const std::vector<Pose>& truth, const std::vector<MonitorInput>& log,
                                                const MonitorParameters& monitor,
                                                const FailureEpisode::Params& params = {},
                                                const SilenceParams& silence = {});

/// Indices of the sweeps at which predictions are judged: 1, 3, 5 s after t1, and every further second before the
/// failure.
std::vector<std::size_t> judgedSweeps(const FailAwareEpisode& episode);

/// Indices of the first sweeps at or after t1 and each further second, to the run's end: the rows of predictions.csv.
std::vector<std::size_t> eachSecond(const FailAwareEpisode& episode);

}  // namespace fail_aware
