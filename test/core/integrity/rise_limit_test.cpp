#include "core/integrity/rise_limit.hpp"

#include <gtest/gtest.h>

namespace fail_aware::rise_limit_test {
namespace {

constexpr double kHorizon_s = 60.0;

TimeToFailure seconds(double time_s) { return TimeToFailure::fromSeconds(time_s, kHorizon_s); }

TEST(RiseLimit, FallsAtOnce) {
  RiseLimit calm;
  EXPECT_EQ(calm.limit(seconds(40.0), 0.1, kHorizon_s).seconds, 40.0);
  EXPECT_EQ(calm.limit(seconds(2.0), 0.1, kHorizon_s).seconds, 2.0);
  EXPECT_EQ(calm.limit(TimeToFailure::reached(), 0.1, kHorizon_s).status, TimeToFailureStatus::kReached);
}

TEST(RiseLimit, RisesByTwoFifthsASecond) {
  RiseLimit by_tenths, at_once;
  by_tenths.limit(seconds(10.0), 0.1, kHorizon_s);
  at_once.limit(seconds(10.0), 1.0, kHorizon_s);
  TimeToFailure time;
  for (int i = 0; i < 10; ++i) time = by_tenths.limit(seconds(50.0), 0.1, kHorizon_s);
  EXPECT_NEAR(time.seconds, 14.0, 1e-9);
  EXPECT_NEAR(at_once.limit(seconds(50.0), 1.0, kHorizon_s).seconds, 14.0, 1e-9) << "whatever the period";
}

TEST(RiseLimit, LeavesZeroAndReachesTheHorizon) {
  RiseLimit calm;
  calm.limit(TimeToFailure::reached(), 0.1, kHorizon_s);
  EXPECT_EQ(calm.limit(seconds(0.3), 0.1, kHorizon_s).seconds, 0.3);
  EXPECT_GT(calm.limit(seconds(50.0), 0.1, kHorizon_s).seconds, 0.5);
  TimeToFailure time;
  for (int i = 0; i < 200; ++i) time = calm.limit(seconds(kHorizon_s), 0.1, kHorizon_s);
  EXPECT_EQ(time.status, TimeToFailureStatus::kBeyondHorizon);
  EXPECT_EQ(time.seconds, kHorizon_s);
}

TEST(RiseLimit, UnknownIsPassedOnAndForgetsTheLast) {
  RiseLimit calm;
  calm.limit(seconds(1.0), 0.1, kHorizon_s);
  EXPECT_FALSE(calm.limit(TimeToFailure::unknown(), 0.1, kHorizon_s).isKnown());
  EXPECT_EQ(calm.limit(seconds(50.0), 0.1, kHorizon_s).seconds, 50.0);
  calm.limit(seconds(1.0), 0.1, kHorizon_s);
  calm.reset();
  EXPECT_EQ(calm.limit(seconds(50.0), 0.1, kHorizon_s).seconds, 50.0);
}

}  // namespace
}  // namespace fail_aware::rise_limit_test
