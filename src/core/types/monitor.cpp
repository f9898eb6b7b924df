#include "fail_aware_lidar_odometry/monitor.hpp"

#include <cmath>
#include <iterator>

namespace fail_aware {

namespace {

// Indexed by bit number.
constexpr const char* kReasonNames[] = {
    "STALE",           "NO_MEASUREMENT",          "PREDICTION_ONLY",  "PREDICTION_OVERRULED", "MEASUREMENTS_DISAGREE",
    "WEAK_DIRECTION",  "SWEEP_INCOMPLETE",        "SWEEP_EMPTY",      "MISSING_ICP_POINT",    "MISSING_ICP_PLANE",
    "MISSING_CORNERS", "ETA_THRESHOLD",           "COVARIANCE_LIMIT", "FROZEN_CLOUD",         "TIME_JUMP",
    "DROPPED_SWEEPS",  "LOW_VISIBILITY",          "NO_ANSWER",        "MOTION_UNKNOWN",       "TIME_FIELD_REFUSED",
    "WEAK_ROAD_AHEAD", "POINT_TIMES_CONTRADICTED"};

}  // namespace

const char* toString(FailAwareState state) {
  switch (state) {
    case FailAwareState::kUnknown: return "UNKNOWN";
    case FailAwareState::kOk: return "OK";
    case FailAwareState::kDegraded: return "DEGRADED";
    case FailAwareState::kFailing: return "FAILING";
    case FailAwareState::kFailed: return "FAILED";
  }
  return "UNKNOWN";
}

std::string reasonText(std::uint32_t reasons) {
  std::string text;
  for (unsigned bit = 0; bit < 32; ++bit) {
    if ((reasons & (1u << bit)) == 0) continue;
    if (!text.empty()) text += '|';
    text += bit < std::size(kReasonNames) ? kReasonNames[bit] : "BIT_" + std::to_string(bit);
  }
  return text;
}

const char* toString(TimeToFailureStatus status) {
  switch (status) {
    case TimeToFailureStatus::kUnknown: return "UNKNOWN";
    case TimeToFailureStatus::kReached: return "REACHED";
    case TimeToFailureStatus::kWithinHorizon: return "WITHIN_HORIZON";
    case TimeToFailureStatus::kBeyondHorizon: return "BEYOND_HORIZON";
  }
  return "UNKNOWN";
}

TimeToFailure TimeToFailure::fromSeconds(double seconds, double horizon_s) {
  if (std::isnan(seconds) || !std::isfinite(horizon_s)) return unknown();
  if (seconds <= 0.0) return reached();
  if (seconds >= horizon_s) return {TimeToFailureStatus::kBeyondHorizon, horizon_s};
  return {TimeToFailureStatus::kWithinHorizon, seconds};
}

TimeToFailure combine(const TimeToFailure& a, const TimeToFailure& b) {
  if (!a.isKnown()) return b;
  if (!b.isKnown()) return a;
  if (a.seconds != b.seconds) return a.seconds < b.seconds ? a : b;
  return a.status == TimeToFailureStatus::kBeyondHorizon ? b : a;
}

}  // namespace fail_aware
