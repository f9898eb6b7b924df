#include "fail_aware_lidar_odometry/core/registration/relocalization.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "fail_aware_lidar_odometry/core/parameters/check.hpp"
#include "synthetic_scene.hpp"

namespace fail_aware {
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
  sigmas << sigma_m, sigma_m, 0.5 * sigma_m, 0.01, 0.01, sigma_yaw_deg * M_PI / 180.0;
  return sigmas.cwiseAbs2().asDiagonal();
}

TEST(Relocalization, FindsWhatTheUsualSearchDoesNotReach) {
  const Pose T_true = poseOf(1.0, 0.2, 0.0, 0.0, 0.0, 2.0);
  const std::vector<Eigen::Vector3d> scene = sampleScene(street(), 6.0, kNoise_m, 3);
  const VoxelMap map = mapOf(scene, T_true);
  const Pose T_predicted = poseOf(4.0, -1.3, 1.1, 0.0, 0.0, 4.0);
  const Matrix6d P = covarianceOf(2.0, 2.0);
  const std::vector<Eigen::Vector3f> points = seenFrom(scene, T_true);
  const Measurement usual = MultiplexIcp(MultiplexIcp::Params()).align(points, map, T_predicted, P);
  EXPECT_TRUE(!usual.ok() || translationError(usual.T_odom_cog, T_true) > 0.3);
  const Relocalization relocalization({}, {});
  ASSERT_TRUE(relocalization.isNeeded(P));
  const std::optional<Pose> T_found = relocalization.find(points, map, T_predicted, P);
  ASSERT_TRUE(T_found);
  EXPECT_LT(translationError(*T_found, T_true), 0.15);
}

TEST(Relocalization, NothingWhereLittleFits) {
  const VoxelMap map = mapOf(sampleScene(street(), 6.0, kNoise_m, 3), Pose::Identity());
  const std::vector<Eigen::Vector3d> elsewhere = sampleScene(room(), 20.0, kNoise_m, 5);
  const Pose T_predicted = poseOf(30.0, 25.0, 6.0, 0.0, 0.0, 30.0);
  EXPECT_FALSE(
      Relocalization({}, {}).find(seenFrom(elsewhere, Pose::Identity()), map, T_predicted, covarianceOf(1.0, 2.0)));
}

TEST(Relocalization, OnlyIfThePredictionIsUncertain) {
  const Relocalization relocalization({}, {});
  EXPECT_FALSE(relocalization.isNeeded(covarianceOf(0.05, 5.0)));
  Relocalization::Params off;
  off.enabled = false;
  EXPECT_FALSE(Relocalization(off, {}).isNeeded(covarianceOf(5.0, 5.0)));
}

TEST(Relocalization, RefusesParametersThatMakeNoSense) {
  Relocalization::Params params;
  params.min_inlier_share = 1.5;
  EXPECT_THROW(Relocalization(params, {}), ParameterError);
}

}  // namespace
}  // namespace fail_aware
