// From a time to failure and reasons to the state that the planner acts on. Pure functions, and the hysteresis.
//
// There are two times: the published time to failure, before which a failure is improbable, and the time to the alarm,
// by which its probability is too large to go on (covariance_predictor.hpp's confidence and alarm_confidence). Eta's time
// to its threshold is in both: the earlier counts.
//
// state        condition (the first that holds)
// FAILED       reason STALE, or the time to the alarm reached
// FAILING      reason FROZEN_CLOUD, or time to the alarm <= failing_s
// UNKNOWN      time to the alarm unknown
// DEGRADED     any of kDegradedReasons, or time to failure <= degraded_s
// OK           otherwise
// A time beyond the horizon counts as the horizon, which is longer than degraded_s (MonitorParameters).
#pragma once

#include <cstdint>

#include "fail_aware_lidar_odometry/monitor.hpp"

namespace fail_aware {

constexpr std::uint32_t kFailedReasons = kReasonStale;
constexpr std::uint32_t kFailingReasons = kReasonFrozenCloud;
constexpr std::uint32_t kDegradedReasons = kReasonNoMeasurement | kReasonPredictionOnly | kReasonPredictionOverruled |
                                           kReasonMeasurementsDisagree | kReasonWeakDirection | kReasonSweepIncomplete |
                                           kReasonSweepEmpty | kReasonMissingIcpPoint | kReasonMissingIcpPlane |
                                           kReasonTimeJump | kReasonDroppedSweeps | kReasonLowVisibility |
                                           kReasonNoAnswer | kReasonTimeFieldRefused;

struct FailureThresholds {
  double failing_s = 3.0;  ///< a safe stop must start now
  double degraded_s = 10.0;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("failing_s", self.failing_s);
    v("degraded_s", self.degraded_s);
  }
  void validate() const;
};

FailAwareState stateFor(const TimeToFailure& time_to_alarm, const TimeToFailure& time_to_failure,
                        const FailureThresholds& thresholds, std::uint32_t reasons);

/// Gets worse at once (OK < DEGRADED < UNKNOWN < FAILING < FAILED), better only after `sweeps_to_recover` better sweeps
/// in a row, and then to the worst of those. UNKNOWN is left at once, whichever way.
class StateHysteresis {
 public:
  /// Throws ParameterError if sweeps_to_recover < 1.
  explicit StateHysteresis(int sweeps_to_recover);

  FailAwareState update(FailAwareState now);
  FailAwareState state() const { return state_; }
  void reset();

 private:
  int sweeps_to_recover_;
  FailAwareState state_ = FailAwareState::kUnknown;
  FailAwareState worst_of_better_ = FailAwareState::kOk;
  int better_sweeps_ = 0;
};

}  // namespace fail_aware
