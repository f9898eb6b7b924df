#include "core/estimation/pose_setting.hpp"

#include <gtest/gtest.h>

namespace fail_aware::pose_setting_test {
namespace {

const Pose kBaseCog = poseFromVector((Vector6d() << 0.3, 0.0, 0.5, 0.0, 0.0, 0.0).finished());
const Pose kSet = poseFromVector((Vector6d() << 5.0, 6.0, 0.1, 0.0, 0.0, 1.5).finished());

ExternalPose poseAt(double stamp_s, double variance = 0.01) { return {stamp_s, kSet, variance * Matrix6d::Identity()}; }

FilterState movingAt(double stamp_s) {
  FilterState state;
  state.stamp_s = stamp_s;
  state.dt_s = 0.1;
  state.T_previous_now = expSe3(0.1 * (Vector6d() << 20.0, 0.0, 0.0, 0.0, 0.0, 0.4).finished());
  return state;
}

TEST(PoseSetting, IsMovedToTheEstimateAndUsedUp) {
  PoseSetting setting;
  EXPECT_EQ(setting.offer(poseAt(100.0), 100.0), "");
  EXPECT_TRUE(setting.pending());
  const PoseSetting::AtEstimate set = setting.take(movingAt(100.1), kBaseCog);
  EXPECT_FALSE(setting.pending());
  const Pose expected = kSet * kBaseCog * expSe3(0.1 * (Vector6d() << 20.0, 0.0, 0.0, 0.0, 0.0, 0.4).finished());
  EXPECT_TRUE(set.T_odom_cog.isApprox(expected, 1e-9));
  EXPECT_NEAR(set.covariance(5, 5), 0.01, 1e-12);
  EXPECT_GT(set.covariance(1, 1) + set.covariance(0, 0), 0.02) << "the heading's error over the way";
}

TEST(PoseSetting, IsAtTheEstimateByItsStamp) {
  PoseSetting setting;
  FilterState state;
  state.stamp_s = 5.0;
  for (const auto& [stamp_s, is_at] : {std::pair(0.0, true), {4.99, true}, {5.01, true}, {4.9, false}, {5.1, false}}) {
    ExternalPose pose;
    pose.stamp_s = stamp_s;
    ASSERT_EQ(setting.offer(pose, state.stamp_s), "");
    EXPECT_EQ(setting.isAt(state), is_at) << stamp_s;
  }
}

TEST(PoseSetting, WithoutAStampItHoldsAtTheEstimate) {
  PoseSetting setting;
  EXPECT_EQ(setting.offer(poseAt(0.0, 0.0), 100.0), "");
  const PoseSetting::AtEstimate set = setting.take(movingAt(100.1), kBaseCog);
  EXPECT_TRUE(set.T_odom_cog.isApprox(kSet * kBaseCog, 1e-9));
  EXPECT_TRUE(set.covariance.isZero(1e-15)) << "known exactly";
}

TEST(PoseSetting, WithoutAStampItIsThatOfTheFirstEstimate) {
  PoseSetting setting;
  EXPECT_EQ(setting.offer(poseAt(0.0), 100.0), "");
  setting.wait(100.1);
  setting.wait(100.2);
  EXPECT_TRUE(setting.isAt(movingAt(100.1)));
  EXPECT_FALSE(setting.isAt(movingAt(100.2)));
  EXPECT_EQ(setting.outdated(movingAt(100.6)), "");
  PoseSetting late = setting;
  EXPECT_NE(late.outdated(movingAt(101.2)), "");
  EXPECT_FALSE(late.pending());
  const Pose T_then_now = expSe3(0.5 * (Vector6d() << 20.0, 0.0, 0.0, 0.0, 0.0, 0.4).finished());
  EXPECT_TRUE(setting.take(movingAt(100.6), kBaseCog).T_odom_cog.isApprox(kSet * kBaseCog * T_then_now, 1e-9));
  EXPECT_EQ(setting.offer(poseAt(0.0), 100.6), "");
  EXPECT_TRUE(setting.isAt(movingAt(100.7))) << "nothing of the last one is left";
}

TEST(PoseSetting, SaysWhyItRefuses) {
  PoseSetting setting;
  EXPECT_NE(setting.offer(poseAt(100.0, -1.0), 100.0).find("covariance"), std::string::npos);
  for (const double variance : {0.0, 0.01}) {
    ExternalPose far = poseAt(100.0, variance);
    far.T_odom_base.translation().x() = 1e10;
    EXPECT_NE(setting.offer(far, 100.0).find("beyond"), std::string::npos) << variance;
  }
  ExternalPose gps = poseAt(100.0);
  gps.covariance.bottomRightCorner<3, 3>().setZero();
  EXPECT_NE(setting.offer(gps, 100.0).find("rotation"), std::string::npos) << "a GPS alone tells no heading";
  EXPECT_NE(setting.offer(poseAt(100.0), 101.1).find("stamp"), std::string::npos);
  EXPECT_FALSE(setting.pending());
  EXPECT_EQ(setting.offer(poseAt(100.0), std::nullopt), "") << "before the first sweep";
}

TEST(PoseSetting, WhatWaitedTooLongIsForgotten) {
  PoseSetting setting;
  EXPECT_EQ(setting.offer(poseAt(100.0), std::nullopt), "");
  EXPECT_EQ(setting.outdated(movingAt(100.9)), "");
  EXPECT_TRUE(setting.pending());
  EXPECT_NE(setting.outdated(movingAt(101.1)).find("stamp"), std::string::npos);
  EXPECT_FALSE(setting.pending());
  EXPECT_EQ(setting.offer(poseAt(0.0), std::nullopt), "");
  EXPECT_EQ(setting.outdated(movingAt(500.0)), "") << "it holds at whatever estimate";
}

}  // namespace
}  // namespace fail_aware::pose_setting_test
