#include "core/map/local_map.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace fail_aware::local_map_test {
namespace {

/// One point ahead, seen at the stamp's time plus time_s, and one on the ground below it.
RegistrationCloud cloudAt(double stamp_s, float time_s = 0.0f) {
  RegistrationCloud cloud;
  cloud.stamp_s = stamp_s;
  cloud.map_points_cog = {{20.0f, 0.1f, 1.0f}, {20.0f, 0.1f, -1.0f}};
  cloud.map_times_s = {time_s, time_s};
  return cloud;
}

LocalMap makeLocalMap() {
  AboveGroundReference::Params standing;
  standing.max_above_ground_ratio = 1.0;
  return LocalMap(ReferenceMap::Params(), standing);
}

Pose placeAt(double x_m) {
  Pose T = Pose::Identity();
  T.translation().x() = x_m;
  return T;
}

TEST(LocalMap, KnowsItsFirstAndItsNewestSweep) {
  LocalMap map = makeLocalMap();
  EXPECT_TRUE(map.empty());
  map.insert(cloudAt(1.0), placeAt(0.0), 1.0, false);
  map.insert(cloudAt(1.1), placeAt(2.0), 1.1, false);
  EXPECT_EQ(map.map().points().size(), 4u);
  EXPECT_EQ(map.first().time_s, 1.0);
  EXPECT_EQ(map.newest().time_s, 1.1);
  EXPECT_EQ(map.newest().T_odom_cog.translation().x(), 2.0);
  map.clearPoints();
  EXPECT_TRUE(map.empty());
  EXPECT_EQ(map.first().time_s, 1.0);
  map.insert(cloudAt(1.2), placeAt(4.0), 1.2, false);
  EXPECT_EQ(map.first().time_s, 1.2);
}

TEST(LocalMap, AnotherOdomEmptiesIt) {
  LocalMap map = makeLocalMap();
  map.insert(cloudAt(0.0), placeAt(0.0), 0.0, true);
  EXPECT_FALSE(map.enterOdom(0));
  EXPECT_FALSE(map.empty());
  EXPECT_FALSE(map.aboveGround().map().empty());
  EXPECT_TRUE(map.enterOdom(1));
  EXPECT_FALSE(map.enterOdom(1));
  EXPECT_TRUE(map.empty());
  EXPECT_TRUE(map.aboveGround().map().empty());
}

TEST(LocalMap, ARestartLeavesWhatStands) {
  LocalMap map = makeLocalMap();
  map.insert(cloudAt(0.0), placeAt(0.0), 0.0, true);
  map.clearPoints();
  EXPECT_FALSE(map.aboveGround().map().empty());
}

TEST(LocalMap, WhatStandsIsKeptOnlyIfWantedAndDue) {
  LocalMap map = makeLocalMap();
  map.insert(cloudAt(0.0), placeAt(0.0), 0.0, false);
  EXPECT_TRUE(map.aboveGround().map().empty());
  map.insert(cloudAt(0.1), placeAt(2.0), 0.1, true);
  map.insert(cloudAt(0.2), placeAt(4.0), 0.2, true);
  EXPECT_EQ(map.aboveGround().T_odom_cog().translation().x(), 2.0);
}

TEST(LocalMap, TheFirstSweepIsRedeskewedWhileItIsAlone) {
  Vector6d twist_cog = Vector6d::Zero();
  twist_cog[0] = 10.0;
  LocalMap map = makeLocalMap();
  map.insert(cloudAt(0.0, 0.05f), placeAt(0.0), 0.0, false);
  map.redeskewFirst(twist_cog, 0.0);
  for (const Eigen::Vector3d& p : map.map().points()) EXPECT_NEAR(p.x(), 20.5, 1e-4);
  map.insert(cloudAt(0.1), placeAt(60.0), 0.1, false);
  const std::vector<Eigen::Vector3d> before = map.map().points();
  map.redeskewFirst(twist_cog, 0.0);
  EXPECT_EQ(map.map().points(), before);
}

TEST(LocalMap, ACompensatedFirstSweepStaysAsItCame) {
  Vector6d twist_cog = Vector6d::Zero();
  twist_cog[0] = 10.0;
  RegistrationCloud cloud = cloudAt(0.0, 0.05f);
  cloud.compensated = true;
  LocalMap map = makeLocalMap();
  map.insert(cloud, placeAt(0.0), 0.0, false);
  map.redeskewFirst(twist_cog, 0.0);
  for (const Eigen::Vector3d& p : map.map().points()) EXPECT_NEAR(p.x(), 20.0, 1e-5);
}

TEST(LocalMap, AResetForgetsTheSweepsAndNotTheNumbers) {
  LocalMap map = makeLocalMap();
  map.enterOdom(3);
  map.insert(cloudAt(0.0), placeAt(0.0), 0.0, true);
  map.reset();
  EXPECT_TRUE(map.empty());
  EXPECT_TRUE(map.aboveGround().map().empty());
  EXPECT_FALSE(map.enterOdom(3));
}

}  // namespace
}  // namespace fail_aware::local_map_test
