#include "core/geometry/rigid_alignment.hpp"

#include <gtest/gtest.h>

#include <optional>
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

std::optional<Pose> aligned(const Points& source, const Points& target) {
  return alignRigid(source, target, std::vector<double>(source.size(), 1.0));
}

TEST(RigidAlignment, RecoversAKnownMotion) {
  for (const Points* points : {&kSolid, &kPlanar}) {
    const std::optional<Pose> T = aligned(*points, moved(knownMotion(), *points));
    ASSERT_TRUE(T);
    EXPECT_TRUE(T->isApprox(knownMotion(), 1e-12));
  }
}

TEST(RigidAlignment, HalfATurnIsNotMistakenForAReflection) {
  Pose T = Pose::Identity();
  T.linear() = rotationFromRpy(0.0, 0.0, 3.14159265358979);
  const std::optional<Pose> found = aligned(kPlanar, moved(T, kPlanar));
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->isApprox(T, 1e-9));
}

TEST(RigidAlignment, MirroredPointsStillGiveAProperRotation) {
  Points mirrored = kSolid;
  for (Eigen::Vector3d& p : mirrored) p.z() = -p.z();
  const std::optional<Pose> T = aligned(kSolid, mirrored);
  ASSERT_TRUE(T);
  EXPECT_NEAR(T->linear().determinant(), 1.0, 1e-12);
}

TEST(RigidAlignment, CollinearPointsLeaveTheTurnAboutTheirLineOpen) {
  const Points line{{0, 0, 0}, {1, 1, 2}, {2, 2, 4}, {-3, -3, -6}};
  EXPECT_FALSE(aligned(line, moved(knownMotion(), line)));
}

TEST(RigidAlignment, TooFewPointsAreNoAlignment) {
  EXPECT_FALSE(aligned({}, {}));
  EXPECT_FALSE(aligned({{1, 2, 3}}, {{4, 5, 6}}));
  EXPECT_FALSE(aligned({{1, 2, 3}, {2, 2, 3}}, {{4, 5, 6}, {4, 6, 6}}));
}

TEST(RigidAlignment, WeightsDecideBetweenContradictingPairs) {
  const Points source{{0, 0, 0}, {10, 0, 0}, {0, 10, 0}};
  Points target = source;
  target[0].x() = 0.4;
  const double heavy = alignRigid(source, target, {100, 1, 1})->translation().x();
  const double light = alignRigid(source, target, {0.01, 1, 1})->translation().x();
  EXPECT_GT(heavy, 0.3);
  EXPECT_LT(light, 0.1);
}

}  // namespace
}  // namespace fail_aware::rigid_alignment_test
