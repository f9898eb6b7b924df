#include "core/geometry/rigid_alignment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/geometry/rotation.hpp"

namespace fail_aware::rigid_alignment_test {
namespace {

using Points = std::vector<Eigen::Vector3d>;

Pose knownMotion() {
  Pose T = Pose::Identity();
  T.linear() = rotationFromRpy(0.3, -0.4, 2.5);
  T.translation() = Eigen::Vector3d(12.0, -7.0, 0.5);
  return T;
}

Points moved(const Pose& T, const Points& points) {
  Points result;
  for (const Eigen::Vector3d& p : points) result.push_back(T * p);
  return result;
}

const Points kSolid{{0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {0, 0, 1}, {1, 1, 1}};
const Points kPlanar{{0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {5, 5, 0}};

TEST(RigidAlignment, RecoversAKnownMotion) {
  for (const Points* points : {&kSolid, &kPlanar}) {
    const RigidAlignment result = alignRigid(*points, moved(knownMotion(), *points));
    ASSERT_TRUE(result.ok());
    EXPECT_EQ(result.rank, points == &kSolid ? 3 : 2);
    EXPECT_TRUE(result.T_target_source.isApprox(knownMotion(), 1e-12));
    EXPECT_NEAR(result.rms_m, 0.0, 1e-12);
  }
}

TEST(RigidAlignment, HalfATurnIsNotMistakenForAReflection) {
  Pose T = Pose::Identity();
  T.linear() = rotationFromRpy(0.0, 0.0, 3.14159265358979);
  const RigidAlignment result = alignRigid(kPlanar, moved(T, kPlanar));
  ASSERT_TRUE(result.ok());
  EXPECT_TRUE(result.T_target_source.isApprox(T, 1e-9));
}

TEST(RigidAlignment, MirroredPointsStillGiveAProperRotation) {
  Points mirrored = kSolid;
  for (Eigen::Vector3d& p : mirrored) p.z() = -p.z();
  const RigidAlignment result = alignRigid(kSolid, mirrored);
  ASSERT_TRUE(result.ok());
  EXPECT_NEAR(result.T_target_source.linear().determinant(), 1.0, 1e-12);
  EXPECT_GT(result.rms_m, 0.1);
}

TEST(RigidAlignment, CollinearPointsLeaveTheTurnAboutTheirLineOpen) {
  const Points line{{0, 0, 0}, {1, 1, 2}, {2, 2, 4}, {-3, -3, -6}};
  const RigidAlignment result = alignRigid(line, moved(knownMotion(), line));
  EXPECT_FALSE(result.ok());
  EXPECT_EQ(result.rank, 1);
  EXPECT_TRUE(result.T_target_source.isApprox(Pose::Identity()));
}

TEST(RigidAlignment, TooFewPointsAreNoAlignment) {
  EXPECT_FALSE(alignRigid({}, {}).ok());
  EXPECT_EQ(alignRigid({{1, 2, 3}}, {{4, 5, 6}}).rank, 0);
  EXPECT_EQ(alignRigid({{1, 2, 3}, {2, 2, 3}}, {{4, 5, 6}, {4, 6, 6}}).rank, 1);
  EXPECT_FALSE(alignRigid({{1, 2, 3}, {2, 2, 3}}, {{4, 5, 6}, {4, 6, 6}}).ok());
}

TEST(RigidAlignment, APairWithoutWeightOrNotFiniteHasNoSay) {
  Points source = kSolid, target = moved(knownMotion(), kSolid);
  source.emplace_back(9, 9, 9);
  target.emplace_back(-50, 0, 0);
  source.emplace_back(1, 1, 1);
  target.emplace_back(std::numeric_limits<double>::quiet_NaN(), 0, 0);
  const RigidAlignment result = alignRigid(source, target, {1, 2, 3, 4, 5, 0, 1});
  ASSERT_TRUE(result.ok());
  EXPECT_TRUE(result.T_target_source.isApprox(knownMotion(), 1e-12));
}

TEST(RigidAlignment, WeightsDecideBetweenContradictingPairs) {
  const Points source{{0, 0, 0}, {10, 0, 0}, {0, 10, 0}};
  Points target = source;
  target[0].x() = 0.4;
  const double heavy = alignRigid(source, target, {100, 1, 1}).T_target_source.translation().x();
  const double light = alignRigid(source, target, {0.01, 1, 1}).T_target_source.translation().x();
  EXPECT_GT(heavy, 0.3);
  EXPECT_LT(light, 0.1);
}

}  // namespace
}  // namespace fail_aware::rigid_alignment_test
