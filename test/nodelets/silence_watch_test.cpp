#include "../../src/nodelets/silence_watch.hpp"

#include <gtest/gtest.h>

namespace fail_aware::silence_watch_test {
namespace {

SilenceWatch watchFrom(double now_s) { return SilenceWatch(SilenceParams{3.0, 0.05, 0.15}, now_s); }

TEST(SilenceWatch, SilenceIsDueAfterThreePeriods) {
  SilenceWatch watch = watchFrom(100.0);
  EXPECT_FALSE(watch.isDue(100.29));
  EXPECT_TRUE(watch.isDue(100.31)) << "the usual period is 0.1 s";
  watch.heard(101.0, 0.06);
  EXPECT_FALSE(watch.isDue(101.17));
  EXPECT_TRUE(watch.isDue(101.19));
  EXPECT_NEAR(watch.silence_s(101.19), 0.19, 1e-9);
  watch.heard(102.0, 0.0);
  EXPECT_TRUE(watch.isDue(102.19)) << "one sweep gives no period";
}

TEST(SilenceWatch, ItIsSaidAgainTenTimesASecond) {
  SilenceWatch watch = watchFrom(100.0);
  watch.published(100.4);
  EXPECT_FALSE(watch.isDue(100.45));
  EXPECT_TRUE(watch.isDue(100.4999)) << "a timer of 0.05 s beats a little early";
}

TEST(SilenceWatch, ADeadlineThatReachesTheSilenceLimitIsNamedOnceThePeriodIsKnown) {
  SilenceWatch watch = watchFrom(100.0);
  for (int i = 0; i < 9; ++i) watch.heard(100.0, i == 4 ? 0.2 : 0.1);  // one sweep was dropped
  EXPECT_EQ(watch.deadlineFault(0.5), std::nullopt);
  watch.heard(100.0, 0.0);
  EXPECT_EQ(watch.deadlineFault(0.5), std::nullopt) << "a first sweep tells no period";
  watch.heard(100.0, 0.1);
  EXPECT_EQ(watch.deadlineFault(0.18), "") << "0.28 s is less than 0.3 s";
  const std::string fault = watch.deadlineFault(0.25).value_or("");
  EXPECT_NE(fault.find("fusion_ukf/deadline_s (0.25 s)"), std::string::npos) << fault;
  EXPECT_NE(fault.find("silence limit (0.30 s, from fail_aware_monitor/stale_sweeps)"), std::string::npos) << fault;
}

TEST(SilenceWatch, AClockThatBeginsAnewCountsFromThere) {
  SilenceWatch watch = watchFrom(100.0);
  watch.published(100.0);
  EXPECT_FALSE(watch.isDue(5.0));
  EXPECT_FALSE(watch.isDue(5.29));
  EXPECT_TRUE(watch.isDue(5.31));
}

}  // namespace
}  // namespace fail_aware::silence_watch_test
