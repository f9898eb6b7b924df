#include "fail_aware_lidar_odometry/monitor.hpp"

#include <cmath>

namespace fail_aware {

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
