// A time to failure that cannot be misread: unknown, reached, so many seconds, or beyond the horizon. Never NaN.
#pragma once

namespace fail_aware {

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

}  // namespace fail_aware
