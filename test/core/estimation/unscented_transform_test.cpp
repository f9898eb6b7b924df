#include "core/estimation/unscented_transform.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../../support/poses.hpp"
#include "core/geometry/rotation.hpp"

namespace fail_aware::unscented_transform_test {
namespace {

/// The three positions as given, the angles of variance 0.01 around 0.
Matrix6d withAngles(const Eigen::Matrix3d& position) {
  Matrix6d C = 0.01 * Matrix6d::Identity();
  C.topLeftCorner<3, 3>() = position;
  return C;
}

TEST(UnscentedTransform, LinearMapsAreExact) {
  Eigen::Matrix3d C_position, F_position;
  C_position << 2.0, 0.3, -0.2, 0.3, 0.5, 0.1, -0.2, 0.1, 0.1;
  F_position << 1.0, 0.4, 0.0, -0.3, 2.0, 0.7, 0.5, 0.0, 1.0;
  const Matrix6d C = withAngles(C_position);
  Matrix6d F = Matrix6d::Identity();
  F.topLeftCorner<3, 3>() = F_position;
  F(3, 4) = -0.6;
  F(0, 5) = 3.0;
  const Vector6d mean = vector6(1.0, -200.0, 3.0, 0.1, 0.2, -0.1), shift = vector6(0.1, 0.2, 0.3, 0.1, 0.0, -0.2);
  SigmaPoints points = sigmaPoints(mean, C);
  for (Vector6d& point : points) point = F * point + shift;
  Vector6d mapped_mean;
  Matrix6d mapped_C;
  unscentedMoments(points, mapped_mean, mapped_C);
  EXPECT_LT((mapped_mean - (F * mean + shift)).norm(), 1e-7);
  EXPECT_LT((mapped_C - F * C * F.transpose()).norm(), 1e-7);
}

TEST(UnscentedTransform, QuadraticMeanIsExact) {
  const Vector6d mean = vector6(1.0, 2.0, 0.0, 0.1, -0.2, 0.0);
  SigmaPoints points = sigmaPoints(mean, withAngles(Eigen::Vector3d(0.5, 0.25, 1.0).asDiagonal()));
  for (Vector6d& point : points) point = point.cwiseAbs2();
  Vector6d mapped_mean;
  Matrix6d mapped_C;
  unscentedMoments(points, mapped_mean, mapped_C);
  EXPECT_LT((mapped_mean - vector6(1.5, 4.25, 1.0, 0.02, 0.05, 0.01)).norm(), 1e-9);
}

TEST(UnscentedTransform, SquareRootOfSemiDefinite) {
  const Vector6d direction = vector6(1.0, 2.0, -1.0, 0.5, 0.0, 0.3).normalized();
  const Matrix6d C = 4.0 * direction * direction.transpose();
  const Matrix6d S = symmetricSquareRoot(C);
  EXPECT_LT((S * S - C).norm(), 1e-9);
  EXPECT_TRUE(symmetricSquareRoot(Matrix6d::Zero()).isZero(0.0));
  EXPECT_TRUE(symmetricSquareRoot(Matrix6d(-1e-12 * Matrix6d::Identity())).allFinite());
}

TEST(UnscentedTransform, AnglesAreAveragedOnTheCircle) {
  Vector6d mean = Vector6d::Zero();
  mean[5] = M_PI - 0.01;
  Matrix6d C = Matrix6d::Identity();
  C(5, 5) = 0.04;
  SigmaPoints points = sigmaPoints(mean, C);
  for (Vector6d& point : points) point[5] = wrapAngle(point[5] + 0.03);
  Vector6d mapped_mean;
  Matrix6d mapped_C;
  unscentedMoments(points, mapped_mean, mapped_C);
  EXPECT_NEAR(mapped_mean[5], -M_PI + 0.02, 1e-12);
  EXPECT_LT((mapped_C - C).norm(), 1e-12);
}

}  // namespace
}  // namespace fail_aware::unscented_transform_test
