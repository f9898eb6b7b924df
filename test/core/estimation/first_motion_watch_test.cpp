#include "core/estimation/first_motion_watch.hpp"

#include <gtest/gtest.h>

namespace fail_aware::first_motion_watch_test {
namespace {

SpeedError error(double sigma_mps) {
  SpeedError error;
  error.variance_m2_s2 = sigma_mps * sigma_mps;
  return error;
}

/// Sweeps of dead reckoning until the search begins again; 0: not within 3000.
int sweepsUntilSearch(FirstMotionWatch& watch, double speed_mps, double sigma_mps) {
  for (int i = 1; i <= 3000; ++i) {
    if (watch.mustSearchAgain(MotionStatus::kDeadReckoning, speed_mps, error(sigma_mps))) return i;
  }
  return 0;
}

TEST(FirstMotionWatch, IsKnownFromTheSecondMeasuredSweepOn) {
  FirstMotionWatch watch;
  watch.addMeasured();
  EXPECT_FALSE(watch.isKnown()) << "the first defines the start pose";
  watch.addMeasured();
  EXPECT_TRUE(watch.isKnown());
  watch.forget();
  EXPECT_FALSE(watch.isKnown());
}

TEST(FirstMotionWatch, AStandstillThatNothingObservesIsDoubtedLessAndLessOften) {
  FirstMotionWatch watch;
  EXPECT_EQ(sweepsUntilSearch(watch, 0.1, 15.0), 20);
  watch.searchAgain();
  EXPECT_EQ(sweepsUntilSearch(watch, 0.1, 15.0), 39) << "40, with the sweep that lost the motion";
  watch.searchAgain();
  EXPECT_EQ(sweepsUntilSearch(watch, 0.1, 15.0), 79);
  watch.reset();
  EXPECT_EQ(sweepsUntilSearch(watch, 0.1, 15.0), 20);
}

TEST(FirstMotionWatch, AStandstillThatIsMeasuredThoughNotPreciselyIsNotDoubted) {
  FirstMotionWatch watch;
  EXPECT_EQ(sweepsUntilSearch(watch, 0.1, 1.0), 0);
  EXPECT_EQ(sweepsUntilSearch(watch, 0.1, 4.0), 20);
}

TEST(FirstMotionWatch, AnObservedStandstillMayEndUnseen) {
  FirstMotionWatch watch;
  EXPECT_FALSE(watch.mustSearchAgain(MotionStatus::kObserved, 0.1, error(0.0)));
  EXPECT_EQ(sweepsUntilSearch(watch, 0.1, 4.0), 20);
  FirstMotionWatch driving;
  EXPECT_FALSE(driving.mustSearchAgain(MotionStatus::kObserved, 1.0, error(0.0)));
  EXPECT_EQ(sweepsUntilSearch(driving, 0.1, 4.0), 0) << "known for good";
}

TEST(FirstMotionWatch, AFoundSpeedIsBelieved) {
  FirstMotionWatch watch;
  EXPECT_FALSE(watch.mustSearchAgain(MotionStatus::kDeadReckoning, 20.0, error(2.0)));
  EXPECT_EQ(sweepsUntilSearch(watch, 0.1, 15.0), 0) << "known for good";
  EXPECT_FALSE(watch.mustSearchAgain(MotionStatus::kObserved, 20.0, error(0.0)));
}

TEST(FirstMotionWatch, AMapMadeAtAGuessedSpeedIsMadeAnew) {
  for (const int guessed : {9, 10}) {
    FirstMotionWatch watch;
    for (int i = 0; i < guessed; ++i) watch.mustSearchAgain(MotionStatus::kDeadReckoning, 12.0, error(15.0));
    EXPECT_EQ(watch.mustSearchAgain(MotionStatus::kObserved, 12.0, error(0.0)), guessed >= 10) << guessed;
    EXPECT_FALSE(watch.mustSearchAgain(MotionStatus::kObserved, 12.0, error(0.0))) << "now it is observed";
  }
}

}  // namespace
}  // namespace fail_aware::first_motion_watch_test
