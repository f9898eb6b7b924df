#include "core/integrity/silence.hpp"

#include <algorithm>

namespace fail_aware {

void SilenceParams::checkRules() const {
  requireParameter(max_period_s >= min_period_s, "max_period_s", max_period_s, "at least min_period_s", min_period_s);
  requireWithin("max_period_s", max_period_s, min_period_s, kLongestPeriod_s);
}

double staleAfter_s(const SilenceParams& params, double period_s) {
  return params.stale_sweeps * std::clamp(period_s, params.min_period_s, params.max_period_s);
}

MonitorOutput staleOutput(MonitorOutput last) {
  last.state = FailAwareState::kFailed;
  last.reasons |= kReasonStale;
  last.time_to_failure = TimeToFailure::reached();
  last.time_to_failure_indicator = last.time_to_failure_covariance = TimeToFailure::unknown();
  last.protection_level_m = -1.0;  // it grows with a motion that nobody knows
  last.standby_state = FailAwareState::kUnknown;
  last.standby_time_to_failure = TimeToFailure::unknown();
  return last;
}

}  // namespace fail_aware
