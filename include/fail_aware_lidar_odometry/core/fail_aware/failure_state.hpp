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
#include <string>

#include "fail_aware_lidar_odometry/core/fail_aware/time_to_failure.hpp"

namespace fail_aware {

enum class FailAwareState : std::uint8_t { kUnknown = 0, kOk = 1, kDegraded = 2, kFailing = 3, kFailed = 4 };

const char* toString(FailAwareState state);

enum ReasonBit : std::uint32_t {
  kReasonStale = 1u << 0,                ///< no filter state for several sweep periods
  kReasonNoMeasurement = 1u << 1,        ///< no algorithm gave a usable measurement
  kReasonPredictionOnly = 1u << 2,       ///< the estimate is the prediction, for whatever cause
  kReasonPredictionOverruled = 1u << 3,  ///< the measurements agreed that the prediction was wrong
  kReasonMeasurementsDisagree = 1u << 4,
  kReasonWeakDirection = 1u << 5,    ///< some horizontal direction is hardly observable
  kReasonSweepIncomplete = 1u << 6,  ///< part of the revolution is missing
  kReasonSweepEmpty = 1u << 7,
  kReasonMissingIcpPoint = 1u << 8,
  kReasonMissingIcpPlane = 1u << 9,
  kReasonMissingCorners = 1u << 10,  ///< usual away from buildings: information, does not degrade
  kReasonEtaThreshold = 1u << 11,    ///< eta is past its threshold: its time is 0, and so the state FAILED
  /// The confidence radius is past the alert limit, or nothing bounds the error: explains, the times decide.
  kReasonCovarianceLimit = 1u << 12,
  kReasonFrozenCloud = 1u << 13,  ///< the sensor repeats itself
  kReasonTimeJump = 1u << 14,
  kReasonDroppedSweeps = 1u << 15,
  kReasonLowVisibility = 1u << 16,    ///< ranges cut short (fog, spray)
  kReasonNoAnswer = 1u << 17,         ///< a stage of the graph was silent: a nodelet is dead, hangs, or is too slow
  kReasonMotionUnknown = 1u << 18,    ///< the motion was not observed yet: t1 waits for it. Explains UNKNOWN
  kReasonTimeFieldRefused = 1u << 19  ///< the cloud's time field cannot be read: its points are timed by a guess
};

constexpr std::uint32_t kFailedReasons = kReasonStale;
constexpr std::uint32_t kFailingReasons = kReasonFrozenCloud;
constexpr std::uint32_t kDegradedReasons = kReasonNoMeasurement | kReasonPredictionOnly | kReasonPredictionOverruled |
                                           kReasonMeasurementsDisagree | kReasonWeakDirection | kReasonSweepIncomplete |
                                           kReasonSweepEmpty | kReasonMissingIcpPoint | kReasonMissingIcpPlane |
                                           kReasonTimeJump | kReasonDroppedSweeps | kReasonLowVisibility |
                                           kReasonNoAnswer | kReasonTimeFieldRefused;

/// "STALE|NO_MEASUREMENT"; empty for none; a bit without a name as "BIT_n".
std::string reasonText(std::uint32_t reasons);

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
