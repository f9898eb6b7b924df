#include "core/integrity/silence.hpp"

#include <gtest/gtest.h>

#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::silence_test {
namespace {

TEST(Silence, IsStaleAfterSomePeriodsWithinBounds) {
  const SilenceParams params;
  EXPECT_DOUBLE_EQ(staleAfter_s(params, 0.1), 0.3);
  EXPECT_DOUBLE_EQ(staleAfter_s(params, 0.0), 0.3) << "the first sweep knows of no period";
  EXPECT_GT(staleAfter_s(params, 0.05), 0.18 + 0.05) << "at 20 Hz a sweep may wait for its deadline";
  EXPECT_DOUBLE_EQ(staleAfter_s(params, 2.0), 0.45) << "after a gap";
}

TEST(Silence, SaysFailedAndKeepsWhatWasKnown) {
  MonitorOutput last;
  last.state = FailAwareState::kOk;
  last.reasons = kReasonMissingCorners;
  last.time_to_failure = TimeToFailure::fromSeconds(20.0, 60.0);
  last.time_to_failure_indicator = last.time_to_failure_covariance = last.time_to_failure;
  last.eta = 1e-4;
  last.protection_level_m = 0.2;
  const MonitorOutput stale = staleOutput(last);
  EXPECT_EQ(stale.state, FailAwareState::kFailed);
  EXPECT_EQ(stale.reasons, kReasonMissingCorners | kReasonStale);
  EXPECT_EQ(stale.time_to_failure.status, TimeToFailureStatus::kReached);
  EXPECT_EQ(stale.time_to_failure_indicator.status, TimeToFailureStatus::kUnknown);
  EXPECT_EQ(stale.time_to_failure_covariance.status, TimeToFailureStatus::kUnknown);
  EXPECT_EQ(stale.eta, 1e-4);
  EXPECT_EQ(stale.protection_level_m, -1.0) << "the vehicle drives on";
}

TEST(Silence, RefusesRulesThatNeverOrAlwaysHold) {
  SilenceParams params;
  params.stale_sweeps = 0.0;
  EXPECT_THROW(validate(params), ParameterError);
  params = SilenceParams();
  params.min_period_s = 0.2;
  EXPECT_THROW(validate(params), ParameterError) << "above max_period_s";
}

}  // namespace
}  // namespace fail_aware::silence_test
