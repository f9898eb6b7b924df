// What the planner gets: the state that it acts on, the reasons for it, and the time to failure.
// doc/planner_contract.md says what they promise. Units: s, m, rad.
#pragma once

#include <Eigen/Core>
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
  kReasonLowVisibility = 1u << 16,     ///< ranges cut short (fog, spray)
  kReasonNoAnswer = 1u << 17,          ///< a stage of the graph was silent: a nodelet is dead, hangs, or is too slow
  kReasonMotionUnknown = 1u << 18,     ///< the motion was not observed yet: t1 waits for it. Explains UNKNOWN
  kReasonTimeFieldRefused = 1u << 19,  ///< the cloud's time field cannot be read: its points are timed by a guess
  kReasonWeakRoadAhead = 1u << 20,     ///< a tunnel or the like is in view: explains the time, does not degrade
  kReasonPointTimesContradicted = 1u << 21  ///< the clouds contradict the settings that time their points
};

/// "STALE|NO_MEASUREMENT"; empty for none; a bit without a name as "BIT_n".
std::string reasonText(std::uint32_t reasons);

/// A time to failure that cannot be misread: unknown, reached, so many seconds, or beyond the horizon. Never NaN.
enum class TimeToFailureStatus {
  kUnknown,        ///< nothing can be said; seconds = -1
  kReached,        ///< already failed; seconds = 0
  kWithinHorizon,  ///< 0 < seconds < horizon
  kBeyondHorizon   ///< no failure before the horizon; seconds = the horizon
};

const char* toString(TimeToFailureStatus status);

struct TimeToFailure {
  TimeToFailureStatus status = TimeToFailureStatus::kUnknown;
  double seconds = -1.0;  ///< s from now

  static TimeToFailure unknown() { return {}; }
  static TimeToFailure reached() { return {TimeToFailureStatus::kReached, 0.0}; }
  /// <= 0: reached; >= horizon_s (infinity too): beyond it; NaN: unknown.
  static TimeToFailure fromSeconds(double seconds, double horizon_s);

  bool isKnown() const { return status != TimeToFailureStatus::kUnknown; }
};

/// The conservative combination: the earlier of the two that are known.
TimeToFailure combine(const TimeToFailure& a, const TimeToFailure& b);

/// The monitor's verdict for one sweep.
struct MonitorOutput {
  double stamp_s = 0.0;
  double t1_stamp_s = -1.0;  ///< -1: does not serve
  FailAwareState state = FailAwareState::kUnknown;
  std::uint32_t reasons = 0;
  TimeToFailure time_to_failure;             ///< what the planner acts on: the earlier of the two
  TimeToFailure time_to_failure_indicator;   ///< from eta
  TimeToFailure time_to_failure_covariance;  ///< from the covariance's growth
  double eta = 0.0;                          ///< integrity/indicator.hpp, rad
  double eta_rate_per_s = -1.0;              ///< -1: unknown
  double sigma_yaw_rad = -1.0;               ///< the filter's; -1: unknown
  double sigma_x_m = 0.0;                    ///< accumulated since t1, in the frame at t1
  double sigma_y_m = 0.0;
  /// What sigma_x_m, sigma_y_m are of; in result.hpp's order.
  Eigen::Matrix<double, 6, 6> covariance_since_start = Eigen::Matrix<double, 6, 6>::Zero();
  /// Bounds the horizontal error, with the predictor's confidence; 1e6: nothing does; -1: unknown.
  double protection_level_m = -1.0;
  /// On the weakest stretch of road in view: ratio of the walls' horizontal information that is along the road; about
  /// 0.001 in a tunnel. 1: not known.
  double min_information_ahead = 1.0;
  double information_ahead_distance_m = 0.0;                ///< to where this stretch begins
  FailAwareState standby_state = FailAwareState::kUnknown;  ///< before t1: if t1 were now
  TimeToFailure standby_time_to_failure;                    ///< likewise
};

}  // namespace fail_aware
