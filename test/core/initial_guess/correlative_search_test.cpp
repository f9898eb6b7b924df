#include "core/initial_guess/correlative_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "../../support/synthetic_scene.hpp"
#include "core/geometry/degree.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::correlative_search_test {
namespace {

using Found = std::optional<Pose>;

VoxelMap mapOf(const Scene& scene) {
  VoxelMap map((VoxelMap::Params()));
  map.insert(seenFrom(sampleScene(scene, 8.0, 0.01, 3), Pose::Identity()), Pose::Identity());
  return map;
}

Matrix6d uncertain(double sigma_m, double sigma_deg) {
  Vector6d sigmas = Vector6d::Constant(0.01);
  sigmas.head<2>().setConstant(sigma_m);
  sigmas[5] = sigma_deg * kDegree;
  return sigmas.cwiseAbs2().asDiagonal();
}

TEST(CorrelativeSearch, FindsAPlaceMetresAndTensOfDegreesAway) {
  const VoxelMap map = mapOf(room());
  const std::vector<Eigen::Vector3d> scene = sampleScene(room(), 8.0, 0.01, 4);
  for (const Pose& T_true : {poseOf(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), poseOf(2.0, -1.5, 0.0, 0.0, 0.0, 40.0)}) {
    for (const Pose& off : {poseOf(4.0, -3.0, 0.0, 0.0, 0.0, 25.0), poseOf(-2.5, 5.0, 0.6, 0.0, 0.0, -33.0)}) {
      Found found;
      ASSERT_TRUE(findByCorrelation({}, seenFrom(scene, T_true), map, T_true * off, uncertain(4.0, 20.0), found));
      ASSERT_TRUE(found);
      const Eigen::Vector3d error = found->translation() - T_true.translation();
      EXPECT_LT(error.head<2>().norm(), 0.6) << "a cell's size";
      EXPECT_NEAR(error.z(), (T_true * off).translation().z(), 1e-9) << "height is the prediction's";
      EXPECT_LT(rotationErrorDeg(*found, T_true), 2.0);
    }
  }
}

TEST(CorrelativeSearch, LooksNoFartherThanThePredictionMayBeOff) {
  const VoxelMap map = mapOf(room());
  const std::vector<Eigen::Vector3f> points = seenFrom(sampleScene(room(), 8.0, 0.01, 4), Pose::Identity());
  Found found;
  ASSERT_TRUE(findByCorrelation({}, points, map, poseOf(4.0, -3.0, 0.0, 0.0, 0.0, 25.0), uncertain(0.2, 1.0), found));
  EXPECT_FALSE(found);
}

TEST(CorrelativeSearch, OneWallOfACorridorBehindTheOtherIsNoPlace) {
  const VoxelMap map = mapOf(corridor());
  const std::vector<Eigen::Vector3f> points = seenFrom(sampleScene(corridor(), 8.0, 0.01, 4), Pose::Identity());
  Found found;
  ASSERT_TRUE(findByCorrelation({}, points, map, poseOf(0.5, 5.0, 0.0, 0.0, 0.0, 6.0), uncertain(4.0, 10.0), found));
  ASSERT_TRUE(found);
  EXPECT_LT(std::abs(found->translation().y()), 0.6);
  EXPECT_NEAR(found->translation().x(), 0.5, 1.5) << "along it the prediction has to do";
}

TEST(CorrelativeSearch, NothingElsewhereAndNotWhereTooLittleStands) {
  Found found;
  const std::vector<Eigen::Vector3f> in_street = seenFrom(sampleScene(street(), 8.0, 0.01, 4), Pose::Identity());
  ASSERT_TRUE(findByCorrelation({}, in_street, mapOf(room()), Pose::Identity(), uncertain(3.0, 10.0), found));
  EXPECT_FALSE(found);
  const std::vector<Eigen::Vector3f> flat =
      seenFrom(sampleScene({ground(-30.0, -30.0, 30.0, 30.0)}, 8.0, 0.01, 4), Pose::Identity());
  EXPECT_FALSE(findByCorrelation({}, flat, mapOf(street()), Pose::Identity(), uncertain(3.0, 10.0), found));
}

TEST(CorrelativeSearch, RefusesParametersThatMakeNoSense) {
  CorrelativeSearchParams params;
  params.max_shift_m = 0.0;
  EXPECT_THROW(validate(params), ParameterError);
}

}  // namespace
}  // namespace fail_aware::correlative_search_test
