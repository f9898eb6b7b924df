// The state that the planner acts on, and the reasons for it. The rules are in fail_aware/failure_state.hpp.
#pragma once

#include <cstdint>
#include <string>

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

/// "STALE|NO_MEASUREMENT"; empty for none; a bit without a name as "BIT_n".
std::string reasonText(std::uint32_t reasons);

}  // namespace fail_aware
