#include "core/map/local_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "../../support/synthetic_scene.hpp"
#include "core/parameters/validate.hpp"

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
  return LocalMap(LocalMap::Params(), standing);
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
  map.redeskewFirstTo(twist_cog, 0.0);
  for (const Eigen::Vector3d& p : map.map().points()) EXPECT_NEAR(p.x(), 20.5, 1e-4);
  map.insert(cloudAt(0.1), placeAt(60.0), 0.1, false);
  const std::vector<Eigen::Vector3d> before = map.map().points();
  map.redeskewFirstTo(twist_cog, 0.0);
  EXPECT_EQ(map.map().points(), before);
}

TEST(LocalMap, ACompensatedFirstSweepStaysAsItCame) {
  Vector6d twist_cog = Vector6d::Zero();
  twist_cog[0] = 10.0;
  RegistrationCloud cloud = cloudAt(0.0, 0.05f);
  cloud.compensated = true;
  LocalMap map = makeLocalMap();
  map.insert(cloud, placeAt(0.0), 0.0, false);
  map.redeskewFirstTo(twist_cog, 0.0);
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

using Points = std::vector<Eigen::Vector3f>;

LocalMap::Params testParams(int sweeps, double range_m = 100.0) {
  LocalMap::Params params;
  params.sweeps = sweeps;
  params.range_m = range_m;
  params.voxels.voxel_size_m = 1.0;
  return params;
}

/// One point, k metres to the left of a vehicle that is k * step_m down the road.
Points sweepNumber(int k) { return {{0.5f, static_cast<float>(k) + 0.5f, 0.5f}}; }
Pose poseNumber(int k, double step_m = 1.0) { return poseOf(k * step_m, 0.0, 0.0, 0.0, 0.0, 0.0); }

/// Which of the sweeps are in the map, by their points' y.
std::vector<int> sweepsIn(const LocalMap& reference) {
  std::vector<int> numbers;
  for (const Eigen::Vector3d& p : reference.map().points()) numbers.push_back(static_cast<int>(p.y()));
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

void add(LocalMap& reference, const Points& points_cog, const Pose& T_odom_cog) {
  RegistrationCloud cloud;
  cloud.map_points_cog = points_cog;
  reference.insert(cloud, T_odom_cog, 0.0, false);
}

TEST(LocalMap, OneSweepIsTheLastSweepOnly) {
  LocalMap reference(testParams(1), {});
  EXPECT_TRUE(reference.map().empty());
  for (int k = 0; k < 5; ++k) {
    add(reference, sweepNumber(k), poseNumber(k));
    EXPECT_EQ(sweepsIn(reference), (std::vector<int>{k}));
  }
  EXPECT_LT((reference.map().points().front() - Eigen::Vector3d(4.5, 4.5, 0.5)).norm(), 1e-6);  // where it was placed
}

TEST(LocalMap, PlanesOfOneSweepDoNotMixWithTheLast) {
  const Scene floor = {ground(-5.0, -5.0, 5.0, 5.0)};
  LocalMap reference(testParams(1), {});
  add(reference, seenFrom(sampleScene(floor, 30.0, 0.0, 1), Pose::Identity()), Pose::Identity());
  add(reference, seenFrom(sampleScene(floor, 30.0, 0.0, 2), Pose::Identity()), poseOf(0.0, 0.0, 0.2, 0.0, 0.0, 0.0));
  VoxelMap::PlaneMatch match;
  VoxelMap::Neighborhood neighborhood;
  ASSERT_TRUE(reference.map().findPlane(Eigen::Vector3d(0.5, 0.5, kGround_m + 0.2), match, neighborhood));
  EXPECT_NEAR(match.distance_m, 0.0f, 1e-4f);
}

TEST(LocalMap, ALocalMapKeepsEverythingWithinItsRange) {
  const double range_m = 30.0;
  LocalMap reference(testParams(0, range_m), {});
  for (int k = 0; k <= 100; ++k) {
    add(reference, {{0.5f, 0.5f, 0.5f}}, poseNumber(k));
    double nearest = 1e9, farthest = 0.0;
    for (const Eigen::Vector3d& p : reference.map().points()) {
      nearest = std::min(nearest, k + 0.5 - p.x());
      farthest = std::max(farthest, k + 0.5 - p.x());
    }
    EXPECT_NEAR(nearest, 0.0, 1e-6);
    EXPECT_GE(farthest, std::min(static_cast<double>(k), range_m) - 1e-6) << k;
    EXPECT_LE(farthest, range_m + 11.0) << k;  // trimmed every 5 m, with 5 m to spare
    EXPECT_EQ(static_cast<int>(reference.map().size()), static_cast<int>(farthest + 1.5));
  }
}

TEST(LocalMap, ALocalMapMayBeginAnywhere) {
  LocalMap reference(testParams(0, 30.0), {});
  const Pose start = poseOf(4000.0, -3000.0, 100.0, 0.0, 0.0, 90.0);
  add(reference, seenFrom(sampleScene(room(), 5.0, 0.01, 1), Pose::Identity()), start);
  EXPECT_GT(reference.map().points().size(), 500u);
}

TEST(LocalMap, ClearForgetsTheSweepsToo) {
  for (const int sweeps : {0, 1}) {
    LocalMap reference(testParams(sweeps), {});
    add(reference, sweepNumber(1), poseNumber(1));
    reference.clear();
    EXPECT_TRUE(reference.map().empty());
    add(reference, sweepNumber(2), poseNumber(2));
    EXPECT_EQ(sweepsIn(reference), (std::vector<int>{2}));
  }
}

TEST(LocalMap, ValidatesItsParameters) {
  EXPECT_NO_THROW(validate(LocalMap::Params()));
  EXPECT_THROW(validate(testParams(-1)), ParameterError);
  EXPECT_THROW(validate(testParams(2)), ParameterError);
  EXPECT_THROW(validate(testParams(0, 0.0)), ParameterError);
}

}  // namespace
}  // namespace fail_aware::local_map_test
