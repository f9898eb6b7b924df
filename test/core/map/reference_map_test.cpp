#include "core/map/reference_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "../../support/synthetic_scene.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::reference_map_test {
namespace {

using Points = std::vector<Eigen::Vector3f>;

ReferenceMap::Params testParams(int sweeps, double range_m = 100.0) {
  ReferenceMap::Params params;
  params.sweeps = sweeps;
  params.range_m = range_m;
  params.voxels.voxel_size_m = 1.0;
  return params;
}

/// One point, k metres to the left of a vehicle that is k * step_m down the road.
Points sweepNumber(int k) { return {{0.5f, static_cast<float>(k) + 0.5f, 0.5f}}; }
Pose poseNumber(int k, double step_m = 1.0) { return poseOf(k * step_m, 0.0, 0.0, 0.0, 0.0, 0.0); }

/// Which of the sweeps are in the map, by their points' y.
std::vector<int> sweepsIn(const ReferenceMap& reference) {
  std::vector<int> numbers;
  for (const Eigen::Vector3d& p : reference.map().points()) numbers.push_back(static_cast<int>(p.y()));
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

TEST(ReferenceMap, OneSweepIsTheLastSweepOnly) {
  ReferenceMap reference(testParams(1));
  EXPECT_TRUE(reference.map().empty());
  for (int k = 0; k < 5; ++k) {
    reference.add(sweepNumber(k), poseNumber(k));
    EXPECT_EQ(sweepsIn(reference), (std::vector<int>{k}));
  }
  EXPECT_LT((reference.map().points().front() - Eigen::Vector3d(4.5, 4.5, 0.5)).norm(), 1e-6);  // where it was placed
}

TEST(ReferenceMap, PlanesOfOneSweepDoNotMixWithTheLast) {
  const Scene floor = {ground(-5.0, -5.0, 5.0, 5.0)};
  ReferenceMap reference(testParams(1));
  reference.add(seenFrom(sampleScene(floor, 30.0, 0.0, 1), Pose::Identity()), Pose::Identity());
  reference.add(seenFrom(sampleScene(floor, 30.0, 0.0, 2), Pose::Identity()), poseOf(0.0, 0.0, 0.2, 0.0, 0.0, 0.0));
  VoxelMap::PlaneMatch match;
  ASSERT_TRUE(reference.map().findPlane(Eigen::Vector3d(0.5, 0.5, kGround_m + 0.2), match));
  EXPECT_NEAR(match.distance_m, 0.0f, 1e-4f);
}

TEST(ReferenceMap, ALocalMapKeepsEverythingWithinItsRange) {
  const double range_m = 30.0;
  ReferenceMap reference(testParams(0, range_m));
  for (int k = 0; k <= 100; ++k) {
    reference.add({{0.5f, 0.5f, 0.5f}}, poseNumber(k));
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

TEST(ReferenceMap, ALocalMapMayBeginAnywhere) {
  ReferenceMap reference(testParams(0, 30.0));
  const Pose start = poseOf(4000.0, -3000.0, 100.0, 0.0, 0.0, 90.0);
  reference.add(seenFrom(sampleScene(room(), 5.0, 0.01, 1), Pose::Identity()), start);
  EXPECT_GT(reference.map().points().size(), 500u);
}

TEST(ReferenceMap, ClearForgetsTheSweepsToo) {
  for (const int sweeps : {0, 1}) {
    ReferenceMap reference(testParams(sweeps));
    reference.add(sweepNumber(1), poseNumber(1));
    reference.clear();
    EXPECT_TRUE(reference.map().empty());
    reference.add(sweepNumber(2), poseNumber(2));
    EXPECT_EQ(sweepsIn(reference), (std::vector<int>{2}));
  }
}

TEST(ReferenceMap, ValidatesItsParameters) {
  EXPECT_NO_THROW(validate(ReferenceMap::Params()));
  EXPECT_THROW(validate(testParams(-1)), ParameterError);
  EXPECT_THROW(validate(testParams(2)), ParameterError);
  EXPECT_THROW(validate(testParams(0, 0.0)), ParameterError);
}

}  // namespace
}  // namespace fail_aware::reference_map_test
