#include "core/initial_guess/relocalization.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "../../support/synthetic_scene.hpp"
#include "core/geometry/degree.hpp"

namespace fail_aware::relocalization_test {
namespace {

constexpr double kNoise_m = 0.01;

VoxelMap mapOf(const std::vector<Eigen::Vector3d>& points, const Pose& T_odom_cog) {
  VoxelMap::Params params;
  params.voxel_size_m = 1.0;
  params.min_point_spacing_m = 0.1;
  params.min_plane_samples = 4;
  VoxelMap map(params);
  map.insert(seenFrom(points, T_odom_cog), T_odom_cog);
  return map;
}

Matrix6d covarianceOf(double sigma_m, double sigma_yaw_deg) {
  Vector6d sigmas;
  sigmas << sigma_m, sigma_m, 0.5 * sigma_m, 0.01, 0.01, sigma_yaw_deg * kDegree;
  return sigmas.cwiseAbs2().asDiagonal();
}

RegistrationCloud cloudOf(const std::vector<Eigen::Vector3f>& points) {
  RegistrationCloud cloud;
  cloud.map_points_cog = cloud.point_points_cog = points;
  return cloud;
}

/// Two seconds at 10 m/s.
constexpr Relocalization::Gap kGap{2.0, 20.0};

TEST(Relocalization, FindsWhatTheUsualSearchDoesNotReach) {
  const Pose T_true = poseOf(1.0, 0.2, 0.0, 0.0, 0.0, 2.0);
  const std::vector<Eigen::Vector3d> scene = sampleScene(street(), 6.0, kNoise_m, 3);
  const VoxelMap map = mapOf(scene, T_true);
  const Pose T_predicted = poseOf(4.0, -1.3, 1.1, 0.0, 0.0, 4.0);
  const Matrix6d P = covarianceOf(2.0, 2.0);
  const std::vector<Eigen::Vector3f> points = seenFrom(scene, T_true);
  const Measurement usual = IcpPointToPoint(IcpPointToPoint::Params()).align(points, map, T_predicted, P);
  EXPECT_TRUE(!usual.ok() || translationError(usual.T_odom_cog, T_true) > 0.3);
  const Relocalization relocalization({}, {});
  ASSERT_TRUE(relocalization.isNeeded(P));
  const std::optional<Pose> T_found = relocalization.find(cloudOf(points), map, T_predicted, P, kGap);
  ASSERT_TRUE(T_found);
  EXPECT_LT(translationError(*T_found, T_true), 0.15);
}

TEST(Relocalization, FindsThePlaceAfterABendThatBeganInTheGap) {
  const Pose T_true = poseOf(1.0, 0.2, 0.0, 0.0, 0.0, 2.0);
  const std::vector<Eigen::Vector3d> scene = sampleScene(street(), 6.0, kNoise_m, 3);
  const VoxelMap map = mapOf(scene, T_true);
  const Pose T_predicted = poseOf(3.0, 4.5, 0.5, 1.0, -1.5, 24.0);
  const Matrix6d P = covarianceOf(0.3, 1.0);
  const RegistrationCloud cloud = cloudOf(seenFrom(scene, T_true));
  const std::optional<Pose> T_found = Relocalization({}, {}).find(cloud, map, T_predicted, P, kGap);
  ASSERT_TRUE(T_found);
  EXPECT_LT(translationError(*T_found, T_true), 0.15);
  EXPECT_FALSE(Relocalization({}, {}).find(cloud, map, T_predicted, P, {0.1, 1.0})) << "no time to get there";
  Relocalization::Params without;
  without.search.enabled = false;
  const std::optional<Pose> T_near = Relocalization(without, {}).find(cloud, map, T_predicted, P, kGap);
  EXPECT_TRUE(!T_near || translationError(*T_near, T_true) > 0.3);
}

TEST(Relocalization, WhereNothingStandsTheWiderSeedsHaveToDo) {
  Scene flat = {ground(-30.0, -20.0, 30.0, 20.0), wall(-20.0, 12.0, 20.0, 12.0, 0.3),
                wall(18.0, -12.0, 18.0, 12.0, 0.3)};
  const std::vector<Eigen::Vector3d> scene = sampleScene(flat, 6.0, kNoise_m, 3);
  const VoxelMap map = mapOf(scene, Pose::Identity());
  const RegistrationCloud cloud = cloudOf(seenFrom(scene, Pose::Identity()));
  EXPECT_TRUE(
      Relocalization({}, {}).find(cloud, map, poseOf(0.3, 0.2, 0.1, 0.0, 0.0, 0.0), covarianceOf(0.3, 1.0), kGap));
}

TEST(Relocalization, NothingWhereLittleFits) {
  const VoxelMap map = mapOf(sampleScene(street(), 6.0, kNoise_m, 3), Pose::Identity());
  const std::vector<Eigen::Vector3d> elsewhere = sampleScene(room(), 20.0, kNoise_m, 5);
  const Pose T_predicted = poseOf(30.0, 25.0, 6.0, 0.0, 0.0, 30.0);
  EXPECT_FALSE(Relocalization({}, {}).find(cloudOf(seenFrom(elsewhere, Pose::Identity())), map, T_predicted,
                                           covarianceOf(1.0, 2.0), kGap));
}

TEST(Relocalization, OnlyIfThePredictionIsUncertain) {
  const Relocalization relocalization({}, {});
  EXPECT_FALSE(relocalization.isNeeded(covarianceOf(0.05, 5.0)));
  Matrix6d uncertain_height = covarianceOf(0.05, 5.0);
  uncertain_height(2, 2) = 0.25;
  EXPECT_FALSE(relocalization.isNeeded(uncertain_height)) << "the search is seen from above";
  Relocalization::Params off;
  off.enabled = false;
  EXPECT_FALSE(Relocalization(off, {}).isNeeded(covarianceOf(5.0, 5.0)));
}

}  // namespace
}  // namespace fail_aware::relocalization_test
