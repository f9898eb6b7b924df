#include "core/geometry/decompositions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "../../support/poses.hpp"
#include "../../support/random_orthogonal.hpp"

namespace fail_aware::decompositions_test {
namespace {

TEST(SymmetricEigen, FindsTheAxesAMatrixWasMadeOf) {
  std::mt19937 random(7);
  const Vector6d values = vector6(-2.0, 1e-6, 0.5, 0.5, 3.0, 1e4);
  for (int trial = 0; trial < 20; ++trial) {
    const Matrix6d Q = randomOrthogonal(random);
    const Matrix6d C = Q * values.asDiagonal() * Q.transpose();
    const auto eigen = symmetricEigen(C);
    EXPECT_LT((eigen.eigenvalues() - values).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT((C * eigen.eigenvectors() - eigen.eigenvectors() * values.asDiagonal()).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT((symmetricEigenvalues(C) - values).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(SymmetricEigen, ReadsTheLowerTriangleOnly) {
  Matrix6d C = Vector6d::LinSpaced(1.0, 6.0).asDiagonal();
  C(0, 5) = 100.0;
  EXPECT_LT((symmetricEigenvalues(C) - Vector6d::LinSpaced(1.0, 6.0)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((symmetricEigen(C).eigenvalues() - Vector6d::LinSpaced(1.0, 6.0)).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(SymmetricEigen, OfAPlaneAndOfSpace) {
  Eigen::Matrix2d plane;
  plane << 2.0, 100.0, 1.0, 2.0;  // its upper triangle is not read
  const auto in_plane = symmetricEigen(plane);
  EXPECT_LT((in_plane.eigenvalues() - Eigen::Vector2d(1.0, 3.0)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_NEAR(std::abs(in_plane.eigenvectors().col(1).dot(Eigen::Vector2d(1.0, 1.0))), std::sqrt(2.0), 1e-12);
  Eigen::Matrix3d space;
  space << 2.0, 100.0, 100.0, 1.0, 2.0, 100.0, 0.0, 0.0, 5.0;
  const auto in_space = symmetricEigen(space);
  EXPECT_LT((in_space.eigenvalues() - Eigen::Vector3d(1.0, 3.0, 5.0)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_NEAR(std::abs(in_space.eigenvectors()(2, 2)), 1.0, 1e-12);
}

const Vector6d kScales = vector6(1e-3, 0.1, 1.0, 2.0, 50.0, 1e3);

TEST(Matrix6, TheInverseUndoes) {
  std::mt19937 random(3);
  const Matrix6d A = randomOrthogonal(random) * kScales.asDiagonal() * randomOrthogonal(random);
  EXPECT_LT((inverseOf(A) * A - Matrix6d::Identity()).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_FALSE(inverseOf(Matrix6d::Zero()).allFinite());
}

TEST(Matrix6, TheSolutionSolves) {
  std::mt19937 random(4);
  const Matrix6d Q = randomOrthogonal(random);
  Matrix6d H = Q * kScales.asDiagonal() * Q.transpose();
  const Vector6d x = vector6(1.0, -2.0, 3.0, -4.0, 5.0, -6.0);
  const Matrix6d X = randomOrthogonal(random);
  const Vector6d b = H * x;
  const Matrix6d B = H * X;
  H.triangularView<Eigen::StrictlyUpper>().setConstant(1e6);  // is not read
  EXPECT_LT((solutionOf(H, b) - x).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT((solutionOf(H, B) - X).cwiseAbs().maxCoeff(), 1e-8);
}

}  // namespace
}  // namespace fail_aware::decompositions_test
