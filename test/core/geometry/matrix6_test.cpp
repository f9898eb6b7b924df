#include "core/geometry/matrix6.hpp"

#include <gtest/gtest.h>

#include <random>

#include "../../support/poses.hpp"
#include "../../support/random_orthogonal.hpp"

namespace fail_aware::matrix6_test {
namespace {

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
}  // namespace fail_aware::matrix6_test
