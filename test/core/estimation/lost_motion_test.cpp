#include "core/estimation/lost_motion.hpp"

#include <gtest/gtest.h>

#include <optional>

namespace fail_aware::lost_motion_test {
namespace {

constexpr double kBelievedRatio = 0.3;

/// Adds sweeps with that inlier ratio; whether the motion was lost in one of them.
bool addSweeps(LostMotion& lost_motion, int sweeps, bool dead_reckoned, std::optional<double> ratio) {
  bool lost = false;
  for (int i = 0; i < sweeps; ++i) lost = lost_motion.add(dead_reckoned, ratio) || lost;
  return lost;
}

/// A town, then a tunnel.
LostMotion afterTunnel(double believed_ratio = kBelievedRatio) {
  LostMotion lost_motion(believed_ratio);
  EXPECT_FALSE(addSweeps(lost_motion, 30, false, 0.88));
  EXPECT_FALSE(addSweeps(lost_motion, 30, true, 0.93));
  return lost_motion;
}

TEST(LostMotion, MisfitAfterDeadReckoningIsLost) {
  LostMotion lost_motion = afterTunnel();
  EXPECT_FALSE(addSweeps(lost_motion, 4, false, 0.5));
  EXPECT_TRUE(addSweeps(lost_motion, 2, false, 0.5)) << "half of the last ten sweeps";
}

TEST(LostMotion, FitThatComesBackIsNotLost) {
  LostMotion lost_motion = afterTunnel();
  EXPECT_FALSE(addSweeps(lost_motion, 2, false, 0.4)) << "the map does not hold the tunnel's end yet";
  EXPECT_FALSE(addSweeps(lost_motion, 60, false, 0.8));
}

TEST(LostMotion, WhatAFaultHidIsNotLost) {
  LostMotion lost_motion(kBelievedRatio);
  addSweeps(lost_motion, 30, false, 0.72);
  addSweeps(lost_motion, 30, true, 0.71);  // a covered sector on a highway; then it is clear again
  for (const double ratio : {0.16, 0.32, 0.46, 0.53, 0.58, 0.60, 0.62, 0.62, 0.65, 0.67, 0.70}) {
    EXPECT_FALSE(lost_motion.add(false, ratio)) << ratio;
  }
}

TEST(LostMotion, MisfitWithoutDeadReckoningIsNotLost) {
  LostMotion lost_motion(kBelievedRatio);
  addSweeps(lost_motion, 30, false, 0.88);
  EXPECT_FALSE(addSweeps(lost_motion, 30, false, 0.4)) << "dense vegetation";
}

TEST(LostMotion, ShortDeadReckoningIsNotWatched) {
  LostMotion lost_motion(kBelievedRatio);
  addSweeps(lost_motion, 30, false, 0.88);
  addSweeps(lost_motion, 9, true, 0.93);
  EXPECT_FALSE(addSweeps(lost_motion, 10, false, 0.4));
}

TEST(LostMotion, UsualRatioIsAssumedUntilItIsKnown) {
  LostMotion lost_motion(kBelievedRatio);
  EXPECT_FALSE(addSweeps(lost_motion, 30, true, 0.93)) << "a start in a tunnel";
  EXPECT_TRUE(addSweeps(lost_motion, 10, false, 0.5));
}

TEST(LostMotion, WhatIsNotBelievedIsNotLost) {
  LostMotion lost_motion = afterTunnel();
  EXPECT_FALSE(addSweeps(lost_motion, 10, true, 0.2)) << "the velocity is held";
}

TEST(LostMotion, OffItNeverLoses) {
  LostMotion lost_motion = afterTunnel(0.0);
  EXPECT_FALSE(addSweeps(lost_motion, 60, false, 0.5));
}

TEST(LostMotion, AfterALossTheSurroundingsMayFitBadly) {
  LostMotion lost_motion = afterTunnel();
  ASSERT_TRUE(addSweeps(lost_motion, 10, false, 0.5));
  addSweeps(lost_motion, 15, true, 0.5);
  EXPECT_FALSE(addSweeps(lost_motion, 60, false, 0.5));
}

TEST(LostMotion, GapEndsTheWatch) {
  LostMotion lost_motion = afterTunnel();
  addSweeps(lost_motion, 1, true, std::nullopt);
  EXPECT_FALSE(addSweeps(lost_motion, 10, false, 0.4)) << "relocalization searches in the map";
}

TEST(LostMotion, ClearedItForgets) {
  LostMotion lost_motion = afterTunnel();
  lost_motion.clear();
  EXPECT_FALSE(addSweeps(lost_motion, 10, false, 0.4));
}

}  // namespace
}  // namespace fail_aware::lost_motion_test
