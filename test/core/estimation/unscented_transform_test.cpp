#include "core/estimation/unscented_transform.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/rotation.hpp"

namespace fail_aware::unscented_transform_test {
namespace {

using Matrix3 = Eigen::Matrix3d;
using Vector3 = Eigen::Vector3d;

TEST(UnscentedTransform, MeanWeightsSumToOne) {
  for (const double alpha : {1e-3, 0.1, 0.5, 1.0}) {
    const UnscentedWeights weights = unscentedWeights({alpha, 2.0, 0.0}, 6);
    EXPECT_NEAR(weights.mean_centre + 12.0 * weights.other, 1.0, 1e-9);
    EXPECT_NEAR(weights.spread * weights.spread * 2.0 * weights.other, 1.0, 1e-12);
    EXPECT_NEAR(weights.covariance_centre - weights.mean_centre, 3.0 - alpha * alpha, 1e-9);
  }
}

TEST(UnscentedTransform, LinearMapsAreExact) {
  Matrix3 C, F;
  C << 2.0, 0.3, -0.2, 0.3, 0.5, 0.1, -0.2, 0.1, 0.1;
  F << 1.0, 0.4, 0.0, -0.3, 2.0, 0.7, 0.5, 0.0, 1.0;
  const Vector3 mean(1.0, -200.0, 3.0), shift(0.1, 0.2, 0.3);
  for (const double alpha : {1e-3, 0.1, 1.0}) {
    const UnscentedWeights weights = unscentedWeights({alpha, 2.0, 0.0}, 3);
    SigmaPoints<3> points = sigmaPoints<EuclideanSpace, 3>(mean, C, weights);
    for (Vector3& point : points) point = F * point + shift;
    Vector3 mapped_mean;
    Matrix3 mapped_C;
    unscentedMoments<EuclideanSpace, 3>(points, weights, mapped_mean, mapped_C);
    EXPECT_LT((mapped_mean - (F * mean + shift)).norm(), 1e-7);
    EXPECT_LT((mapped_C - F * C * F.transpose()).norm(), 1e-7);
  }
}

TEST(UnscentedTransform, QuadraticMeanIsExact) {
  const UnscentedWeights weights = unscentedWeights({0.1, 2.0, 0.0}, 3);
  const Vector3 mean(1.0, 2.0, 0.0);
  SigmaPoints<3> points = sigmaPoints<EuclideanSpace, 3>(mean, Vector3(0.5, 0.25, 1.0).asDiagonal(), weights);
  for (Vector3& point : points) point = point.cwiseAbs2();
  Vector3 mapped_mean;
  Matrix3 mapped_C;
  unscentedMoments<EuclideanSpace, 3>(points, weights, mapped_mean, mapped_C);
  EXPECT_LT((mapped_mean - Vector3(1.5, 4.25, 1.0)).norm(), 1e-9);
}

TEST(UnscentedTransform, SquareRootOfSemiDefinite) {
  const Vector3 direction = Vector3(1.0, 2.0, -1.0).normalized();
  const Matrix3 C = 4.0 * direction * direction.transpose();
  const Matrix3 S = symmetricSquareRoot<3>(C);
  EXPECT_LT((S * S - C).norm(), 1e-9);
  EXPECT_TRUE(symmetricSquareRoot<3>(Matrix3::Zero()).isZero(0.0));
  EXPECT_TRUE(symmetricSquareRoot<3>(Matrix3(-1e-12 * Matrix3::Identity())).allFinite());
}

TEST(UnscentedTransform, AnglesAreAveragedOnTheCircle) {
  Vector6d mean = Vector6d::Zero();
  mean[5] = M_PI - 0.01;
  Matrix6d C = Matrix6d::Identity();
  C(5, 5) = 0.04;
  const UnscentedWeights weights = unscentedWeights({1.0, 2.0, 0.0}, 6);
  SigmaPoints<6> points = sigmaPoints<PoseStateSpace, 6>(mean, C, weights);
  for (Vector6d& point : points) point[5] = wrapAngle(point[5] + 0.03);
  Vector6d mapped_mean;
  Matrix6d mapped_C;
  unscentedMoments<PoseStateSpace, 6>(points, weights, mapped_mean, mapped_C);
  EXPECT_NEAR(mapped_mean[5], -M_PI + 0.02, 1e-12);
  EXPECT_LT((mapped_C - C).norm(), 1e-12);
}

}  // namespace
}  // namespace fail_aware::unscented_transform_test
