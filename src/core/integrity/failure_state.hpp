// From a time to failure and reasons to the state that the planner acts on. Pure functions, and the hysteresis.
//
// There are two times: the published time to failure, before which a failure is improbable, and the time to the alarm,
// by which its probability is too large to go on (covariance_predictor.hpp's confidence and alarm_confidence). Eta's
// time to its threshold is in both: the earlier counts. The published time never exceeds the time to the alarm.
//
// A stop from the present speed v takes v / comfortable_deceleration_mps2. FAILING says that it must begin now,
// DEGRADED that twice that time is left, so that there is time to slow down.
//
// state        condition (the first that holds)
// FAILED       reason STALE, or the time to the alarm reached
// FAILING      reason FROZEN_CLOUD, or time to failure <= max(failing_s, stop from v)
// UNKNOWN      time to failure unknown
// DEGRADED     any of kDegradedReasons, or time to failure <= max(degraded_s, 2 x stop from v)
// OK           otherwise; so is a time beyond the horizon, whatever the speed
#pragma once

#include <cstdint>

#include "core/parameters/check.hpp"
#include "fail_aware_lidar_odometry/monitor.hpp"

namespace fail_aware {

constexpr std::uint32_t kFailedReasons = kReasonStale;
constexpr std::uint32_t kFailingReasons = kReasonFrozenCloud;
constexpr std::uint32_t kDegradedReasons = kReasonNoMeasurement | kReasonPredictionOnly | kReasonPredictionOverruled |
                                           kReasonMeasurementsDisagree | kReasonWeakDirection | kReasonSweepIncomplete |
                                           kReasonSweepEmpty | kReasonMissingIcpPoint | kReasonMissingIcpPlane |
                                           kReasonTimeJump | kReasonDroppedSweeps | kReasonLowVisibility |
                                           kReasonNoAnswer | kReasonTimeFieldRefused | kReasonPointTimesContradicted;

struct FailureThresholds {
  double comfortable_deceleration_mps2 = 2.0;  ///< of the safe stop
  double failing_s = 1.0;                      ///< the shortest stop: at standstill, too
  double degraded_s = 10.0;                    ///< at least

  /// A safe stop from this speed must start when no more time is left than this.
  double failingWithin_s(double speed_mps) const;
  double degradedWithin_s(double speed_mps) const;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("comfortable_deceleration_mps2", self.comfortable_deceleration_mps2, within(0.1, 100.0));
    v("failing_s", self.failing_s, requireNotNegative);
    v("degraded_s", self.degraded_s);
  }
  void checkRules() const;
};

FailAwareState stateFor(const TimeToFailure& time_to_alarm, const TimeToFailure& time_to_failure,
                        const FailureThresholds& thresholds, std::uint32_t reasons, double speed_mps);

/// Gets worse at once (OK < DEGRADED < UNKNOWN < FAILING < FAILED), better only after `sweeps_to_recover` better sweeps
/// in a row, and then to the worst of those. UNKNOWN is left at once, whichever way.
class StateHysteresis {
 public:
  explicit StateHysteresis(int sweeps_to_recover) : sweeps_to_recover_(sweeps_to_recover) {}

  FailAwareState update(FailAwareState now);
  void reset() { *this = StateHysteresis(sweeps_to_recover_); }

 private:
  int sweeps_to_recover_;
  FailAwareState state_ = FailAwareState::kUnknown;
  FailAwareState worst_of_better_ = FailAwareState::kOk;
  int better_sweeps_ = 0;
};

}  // namespace fail_aware
