#include "core/integrity/failure_state.hpp"

#include <cmath>

namespace fail_aware {

namespace {

int severity(FailAwareState state) {
  switch (state) {
    case FailAwareState::kOk: return 0;
    case FailAwareState::kDegraded: return 1;
    case FailAwareState::kUnknown: return 2;
    case FailAwareState::kFailing: return 3;
    case FailAwareState::kFailed: return 4;
  }
  return 4;
}

}  // namespace

void FailureThresholds::checkRules() const {
  requireParameter(std::isfinite(degraded_s) && degraded_s >= failing_s, "degraded_s", degraded_s,
                   "finite and >= failing_s", failing_s);
  requireWithin("degraded_s", degraded_s, failing_s, kLargestParameter);
}

double FailureThresholds::failingWithin_s(double speed_mps) const {
  return std::max(failing_s, std::abs(speed_mps) / comfortable_deceleration_mps2);
}

double FailureThresholds::degradedWithin_s(double speed_mps) const {
  return std::max(degraded_s, 2.0 * failingWithin_s(speed_mps));
}

FailAwareState stateFor(const TimeToFailure& time_to_alarm, const TimeToFailure& time_to_failure,
                        const FailureThresholds& thresholds, std::uint32_t reasons, double speed_mps) {
  const auto isWithin = [](const TimeToFailure& time, double seconds) {
    return time.isKnown() && time.status != TimeToFailureStatus::kBeyondHorizon && time.seconds <= seconds;
  };
  if ((reasons & kFailedReasons) || isWithin(time_to_alarm, 0.0)) return FailAwareState::kFailed;
  if ((reasons & kFailingReasons) || isWithin(time_to_failure, thresholds.failingWithin_s(speed_mps))) {
    return FailAwareState::kFailing;
  }
  if (!time_to_failure.isKnown()) return FailAwareState::kUnknown;
  if ((reasons & kDegradedReasons) || isWithin(time_to_failure, thresholds.degradedWithin_s(speed_mps))) {
    return FailAwareState::kDegraded;
  }
  return FailAwareState::kOk;
}

FailAwareState StateHysteresis::update(FailAwareState now) {
  if (state_ == FailAwareState::kUnknown || severity(now) >= severity(state_)) {
    state_ = now;
    better_sweeps_ = 0;
    return state_;
  }
  if (better_sweeps_ == 0 || severity(now) > severity(worst_of_better_)) worst_of_better_ = now;
  if (++better_sweeps_ >= sweeps_to_recover_) {
    state_ = worst_of_better_;
    better_sweeps_ = 0;
  }
  return state_;
}

}  // namespace fail_aware
