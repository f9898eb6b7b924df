#include "../../src/nodelets/pose_setting.hpp"

#include <gtest/gtest.h>

namespace fail_aware {
namespace {

const ros::Time kStamp(100, 0);
const Pose kBaseCog = poseFromVector((Vector6d() << 0.3, 0.0, 0.5, 0.0, 0.0, 0.0).finished());

geometry_msgs::PoseWithCovarianceStamped message(const Pose& T_odom_base, double variance = 0.01) {
  geometry_msgs::PoseWithCovarianceStamped out;
  out.header.frame_id = "odom";
  out.header.stamp = kStamp;
  out.pose.pose = toPoseMessage(T_odom_base);
  out.pose.covariance = toCovarianceMessage(variance * Matrix6d::Identity());
  return out;
}

FilterState movingAt(double stamp_s) {
  FilterState state;
  state.stamp_s = stamp_s;
  state.dt_s = 0.1;
  state.T_previous_now = expSe3(0.1 * (Vector6d() << 20.0, 0.0, 0.0, 0.0, 0.0, 0.4).finished());
  return state;
}

const Pose kSet = poseFromVector((Vector6d() << 5.0, 6.0, 0.1, 0.0, 0.0, 1.5).finished());

TEST(PoseSetting, IsMovedToTheEstimateAndUsedUp) {
  PoseSetting setting;
  EXPECT_EQ(setting.offer(message(kSet), "odom", kStamp), "");
  EXPECT_TRUE(setting.pending());
  const PoseSetting::AtEstimate set = setting.take(movingAt(100.1), kBaseCog);
  EXPECT_FALSE(setting.pending());
  const Pose expected = kSet * kBaseCog * expSe3(0.1 * (Vector6d() << 20.0, 0.0, 0.0, 0.0, 0.0, 0.4).finished());
  EXPECT_TRUE(set.T_odom_cog.isApprox(expected, 1e-9));
  EXPECT_NEAR(set.covariance(5, 5), 0.01, 1e-12);
  EXPECT_GT(set.covariance(1, 1) + set.covariance(0, 0), 0.02) << "the heading's error over the way";
}

TEST(PoseSetting, WithoutAStampItHoldsAtTheEstimate) {
  PoseSetting setting;
  geometry_msgs::PoseWithCovarianceStamped unstamped = message(kSet, 0.0);
  unstamped.header.stamp = ros::Time();
  unstamped.header.frame_id = "/odom";
  EXPECT_EQ(setting.offer(unstamped, "odom", kStamp), "");
  const PoseSetting::AtEstimate set = setting.take(movingAt(100.1), kBaseCog);
  EXPECT_TRUE(set.T_odom_cog.isApprox(kSet * kBaseCog, 1e-9));
  EXPECT_TRUE(set.covariance.isZero(1e-15)) << "known exactly";
}

TEST(PoseSetting, SaysWhyItRefuses) {
  PoseSetting setting;
  geometry_msgs::PoseWithCovarianceStamped bad = message(kSet);
  bad.header.frame_id = "map";
  EXPECT_NE(setting.offer(bad, "odom", kStamp).find("map"), std::string::npos);
  bad = message(kSet);
  bad.pose.pose.orientation.w = 3.0;
  EXPECT_NE(setting.offer(bad, "odom", kStamp).find("quaternion"), std::string::npos);
  bad = message(kSet, -1.0);
  EXPECT_NE(setting.offer(bad, "odom", kStamp).find("covariance"), std::string::npos);
  for (const double variance : {0.0, 0.01}) {
    bad = message(kSet, variance);
    bad.pose.pose.position.x = 1e10;
    EXPECT_NE(setting.offer(bad, "odom", kStamp).find("beyond"), std::string::npos) << variance;
  }
  bad = message(kSet, 0.01);
  for (int i = 21; i < 36; i += 7) bad.pose.covariance[static_cast<std::size_t>(i)] = 0.0;
  EXPECT_NE(setting.offer(bad, "odom", kStamp).find("rotation"), std::string::npos) << "a GPS alone tells no heading";
  bad = message(kSet);
  EXPECT_NE(setting.offer(bad, "odom", kStamp + ros::Duration(1.1)).find("stamp"), std::string::npos);
  EXPECT_FALSE(setting.pending());
  EXPECT_EQ(setting.offer(bad, "odom", ros::Time()), "") << "before the first sweep";
}

TEST(PoseSetting, WhatWaitedTooLongIsForgotten) {
  PoseSetting setting;
  EXPECT_EQ(setting.offer(message(kSet), "odom", ros::Time()), "");
  EXPECT_EQ(setting.outdated(movingAt(100.9)), "");
  EXPECT_TRUE(setting.pending());
  EXPECT_NE(setting.outdated(movingAt(101.1)).find("stamp"), std::string::npos);
  EXPECT_FALSE(setting.pending());
  geometry_msgs::PoseWithCovarianceStamped unstamped = message(kSet);
  unstamped.header.stamp = ros::Time();
  EXPECT_EQ(setting.offer(unstamped, "odom", ros::Time()), "");
  EXPECT_EQ(setting.outdated(movingAt(500.0)), "") << "it holds at whatever estimate";
}

}  // namespace
}  // namespace fail_aware
