#include "core/initial_guess/estimate_track.hpp"

#include <gtest/gtest.h>

namespace fail_aware::estimate_track_test {
namespace {

/// 1 m in 0.1 s, to x_m.
FilterState drivenTo(double x_m, bool measured) {
  FilterState state;
  state.dt_s = 0.1;
  state.T_odom_cog.translation().x() = x_m;
  state.T_previous_now.translation().x() = 1.0;
  state.measurement_applied = measured;
  state.motion_status = measured ? MotionStatus::kObserved : MotionStatus::kDeadReckoning;
  state.map_update = measured ? MapUpdate::kInsert : MapUpdate::kSkip;
  return state;
}

TEST(EstimateTrack, TwoMeasuredEstimatesTellAMotion) {
  EstimateTrack track;
  EXPECT_FALSE(track.add(drivenTo(0.0, true)).twist_cog);
  const EstimateTrack::Increment increment = track.add(drivenTo(1.0, true));
  EXPECT_TRUE(increment.between_measured);
  ASSERT_TRUE(increment.twist_cog);
  EXPECT_NEAR((*increment.twist_cog)[0], 10.0, 1e-12);
  EXPECT_EQ(*track.placedTwist(), *increment.twist_cog);
  EXPECT_EQ(track.T_odom_cog_placed().translation().x(), 1.0);
}

TEST(EstimateTrack, AnIncrementFromAPredictionTellsNone) {
  EstimateTrack track;
  track.add(drivenTo(0.0, true));
  track.add(drivenTo(1.0, false));
  EXPECT_FALSE(track.measured());
  EXPECT_EQ(track.unplaced().size(), 1u);
  EXPECT_EQ(track.T_odom_cog_placed().translation().x(), 0.0);
  const EstimateTrack::Increment increment = track.add(drivenTo(2.0, true));
  EXPECT_FALSE(increment.between_measured);
  EXPECT_FALSE(increment.twist_cog);
  EXPECT_FALSE(track.placedTwist());
  EXPECT_TRUE(track.unplaced().empty());
}

TEST(EstimateTrack, ADoubtedIntervalLeavesTheMotionBefore) {
  EstimateTrack track;
  track.add(drivenTo(0.0, true));
  track.add(drivenTo(1.0, true));
  FilterState wrong = drivenTo(2.0, true);
  wrong.clock_jump = true;
  EXPECT_FALSE(track.add(wrong).twist_cog);
  ASSERT_TRUE(track.placedTwist());
  EXPECT_NEAR((*track.placedTwist())[0], 10.0, 1e-12);
}

TEST(EstimateTrack, TheFirstSweepOfAMapIsMeasuredByDefinition) {
  EstimateTrack track;
  const FilterState first = drivenTo(5.0, false);
  track.add(first);
  track.beginAt(first);
  EXPECT_TRUE(track.measured());
  EXPECT_TRUE(track.unplaced().empty());
  EXPECT_EQ(track.T_odom_cog_placed().translation().x(), 5.0);
  EXPECT_TRUE(track.add(drivenTo(6.0, true)).twist_cog);
}

TEST(EstimateTrack, AfterTenIntervalsTooManyAreUnplaced) {
  EstimateTrack track;
  track.add(drivenTo(0.0, true));
  for (int i = 0; i < 9; ++i) track.add(drivenTo(i, false));
  EXPECT_FALSE(track.tooManyUnplaced());
  for (int i = 0; i < 9; ++i) track.add(drivenTo(i, false));
  EXPECT_TRUE(track.tooManyUnplaced());
  EXPECT_EQ(track.unplaced().size(), 10u);
}

TEST(EstimateTrack, TheSpeedIsObservedUnlessTheFilterCoasts) {
  EstimateTrack track;
  track.add(drivenTo(0.0, true));
  EXPECT_TRUE(track.speedObserved());
  FilterState dead_reckoning = drivenTo(1.0, true);
  dead_reckoning.speed_error.variance_m2_s2 = 4.0;
  track.add(dead_reckoning);
  EXPECT_FALSE(track.speedObserved());
  EXPECT_TRUE(track.speedWasObserved());
  EXPECT_EQ(track.speedSigma_mps(), 2.0);
  dead_reckoning.motion_status = MotionStatus::kUnknown;
  track.add(dead_reckoning);
  EXPECT_FALSE(track.speedWasObserved()) << "it was lost, and is searched for anew";
}

}  // namespace
}  // namespace fail_aware::estimate_track_test
