#include "core/integrity/recent_shortest_time.hpp"

#include <gtest/gtest.h>

namespace fail_aware::recent_shortest_time_test {
namespace {

constexpr double kHorizon_s = 60.0;

TimeToFailure seconds(double time_s) { return TimeToFailure::fromSeconds(time_s, kHorizon_s); }

TEST(RecentShortestTime, FallsAtOnce) {
  RecentShortestTime calm;
  EXPECT_EQ(calm.add(seconds(40.0), 0.1).seconds, 40.0);
  EXPECT_EQ(calm.add(seconds(2.0), 0.1).seconds, 2.0);
  EXPECT_EQ(calm.add(TimeToFailure::reached(), 0.1).status, TimeToFailureStatus::kReached);
}

TEST(RecentShortestTime, RisesAfterFiveSecondsWhateverThePeriod) {
  for (const double dt_s : {0.125, 0.5}) {
    RecentShortestTime calm;
    calm.add(seconds(10.0), dt_s);
    TimeToFailure time;
    for (double since_s = dt_s; since_s <= 5.0; since_s += dt_s) time = calm.add(seconds(50.0), dt_s);
    EXPECT_EQ(time.seconds, 10.0);
    EXPECT_EQ(calm.add(seconds(50.0), dt_s).seconds, 50.0);
  }
  RecentShortestTime after_a_gap;
  after_a_gap.add(seconds(10.0), 0.1);
  EXPECT_EQ(after_a_gap.add(seconds(50.0), 6.0).seconds, 50.0);
}

TEST(RecentShortestTime, ReachesTheHorizon) {
  RecentShortestTime calm;
  calm.add(TimeToFailure::reached(), 0.1);
  TimeToFailure time;
  for (int i = 0; i < 60; ++i) time = calm.add(seconds(kHorizon_s), 0.1);
  EXPECT_EQ(time.status, TimeToFailureStatus::kBeyondHorizon);
  EXPECT_EQ(time.seconds, kHorizon_s);
}

TEST(RecentShortestTime, UnknownIsPassedOnAndForgetsTheOthers) {
  RecentShortestTime calm;
  calm.add(seconds(1.0), 0.1);
  EXPECT_FALSE(calm.add(TimeToFailure::unknown(), 0.1).isKnown());
  EXPECT_EQ(calm.add(seconds(50.0), 0.1).seconds, 50.0);
  calm.add(seconds(1.0), 0.1);
  calm.reset();
  EXPECT_EQ(calm.add(seconds(50.0), 0.1).seconds, 50.0);
}

}  // namespace
}  // namespace fail_aware::recent_shortest_time_test
