#include "core/map/above_ground_reference.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace fail_aware::above_ground_reference_test {
namespace {

AboveGroundReference::Params keepsAnyRatio() {
  AboveGroundReference::Params params;
  params.max_above_ground_ratio = 1.0;
  return params;
}

/// 1.5 m high, on the ground at z = -1.
std::vector<Eigen::Vector3f> onePost() {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i <= 15; ++i) points.emplace_back(10.0f, 5.0f, -1.0f + 0.1f * static_cast<float>(i));
  return points;
}

Pose ahead(double x_m) {
  Pose T = Pose::Identity();
  T.translation().x() = x_m;
  return T;
}

TEST(AboveGroundReference, WhatStandsIsKeptInOdom) {
  AboveGroundReference reference(keepsAnyRatio());
  EXPECT_TRUE(reference.isDue(Pose::Identity(), 0.0));
  reference.keep(onePost(), ahead(3.0), 0.0);
  EXPECT_EQ(reference.T_odom_cog().matrix(), ahead(3.0).matrix());
  ASSERT_FALSE(reference.map().empty());
  for (const Eigen::Vector3d& p : reference.map().points()) EXPECT_NEAR(p.x(), 13.0, 1e-5);
}

TEST(AboveGroundReference, KeptForSomeWayAndTime) {
  AboveGroundReference reference(keepsAnyRatio());
  reference.keep(onePost(), Pose::Identity(), 0.0);
  EXPECT_FALSE(reference.isDue(ahead(9.0), 0.9));
  EXPECT_TRUE(reference.isDue(ahead(11.0), 0.9));
  EXPECT_TRUE(reference.isDue(ahead(9.0), 1.1));
  reference.clear();
  EXPECT_TRUE(reference.isDue(Pose::Identity(), 0.0));
  EXPECT_TRUE(reference.map().empty());
}

TEST(AboveGroundReference, NothingIsKeptAmongBuildings) {
  AboveGroundReference reference{AboveGroundReference::Params()};
  reference.keep(onePost(), Pose::Identity(), 0.0);
  EXPECT_TRUE(reference.map().empty());
  EXPECT_FALSE(reference.isDue(ahead(9.0), 0.9));
  EXPECT_TRUE(reference.isDue(ahead(11.0), 0.9));
}

TEST(AboveGroundReference, SwitchedOffKeepsNothing) {
  AboveGroundReference::Params params = keepsAnyRatio();
  params.enabled = false;
  AboveGroundReference reference(params);
  reference.keep(onePost(), Pose::Identity(), 0.0);
  EXPECT_TRUE(reference.map().empty());
}

}  // namespace
}  // namespace fail_aware::above_ground_reference_test
