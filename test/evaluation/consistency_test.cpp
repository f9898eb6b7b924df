#include "evaluation/consistency.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/geometry/rotation.hpp"

namespace fail_aware::consistency_test {
namespace {

TEST(Consistency, NormalisedErrorByHand) {
  Eigen::Matrix2d P;
  P << 2.0, 1.0, 1.0, 2.0;  // inverse 1/3 [2 -1; -1 2]
  EXPECT_NEAR(normalisedErrorSquared(Eigen::Vector2d(1.0, 0.0), P).value(), 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(normalisedErrorSquared(Eigen::Vector2d(1.0, 1.0), P).value(), 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(normalisedErrorSquared(Eigen::Vector2d(1.0, -1.0), P).value(), 2.0, 1e-12);
}

TEST(Consistency, NoValueWithoutACovariance) {
  const Eigen::Vector2d e(1.0, 0.0);
  EXPECT_FALSE(normalisedErrorSquared(e, Eigen::Matrix2d::Zero()));
  EXPECT_FALSE(normalisedErrorSquared(e, -Eigen::Matrix2d::Identity()));
  EXPECT_FALSE(normalisedErrorSquared(e, Eigen::Matrix2d::Constant(std::nan(""))));
  EXPECT_FALSE(normalisedErrorSquared(Eigen::Vector2d(std::nan(""), 0.0), Eigen::Matrix2d::Identity()));
}

TEST(Consistency, TrueCovariancesGiveOneAndTheGaussianRatios) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::vector<double> six, two, overconfident;
  Matrix6d root = Matrix6d::Identity();
  root(5, 0) = 0.7;
  root(2, 1) = -3.0;
  const Matrix6d P = root * root.transpose();
  for (int i = 0; i < 20000; ++i) {
    const Vector6d e = root * Vector6d::NullaryExpr([&](auto) { return normal(random); });
    six.push_back(normalisedErrorSquared(e, P).value());
    two.push_back(normalisedErrorSquared(e.head<2>(), P.topLeftCorner<2, 2>()).value());
    overconfident.push_back(normalisedErrorSquared(e, 0.25 * P).value());
  }
  const Consistency good = consistencyOf(six, 6).value();
  EXPECT_EQ(good.samples, 20000u);
  EXPECT_NEAR(good.mean_per_dof, 1.0, 0.02);
  EXPECT_NEAR(good.median_over_expected, 1.0, 0.03);
  EXPECT_NEAR(consistencyOf(overconfident, 6)->mean_per_dof, 4.0, 0.1);
  const Consistency horizontal = consistencyOf(two, 2).value();
  EXPECT_NEAR(horizontal.mean_per_dof, 1.0, 0.03);
  EXPECT_NEAR(horizontal.median_over_expected, 1.0, 0.04);
  const double shares[] = {0.393, 0.865, 0.989};  // 1 - exp(-k^2 / 2)
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(horizontal.within_sigma[k], shares[k], 0.01);
  EXPECT_FALSE(consistencyOf({}, 2));
}

TEST(Consistency, OneOutlierMovesTheMeanAndNotTheMedian) {
  const Consistency c = consistencyOf({1.386, 1.386, 1.386, 1.386, 1000.0}, 2).value();
  EXPECT_GT(c.mean_per_dof, 100.0);
  EXPECT_NEAR(c.median_over_expected, 1.0, 0.02);
}

TEST(Consistency, TheErrorOfAMotionIsAboutTheAxesOfItsBegin) {
  Pose estimate = Pose::Identity(), truth = Pose::Identity();
  estimate.linear() = rotationFromRpy(0.0, 0.0, 1.0);
  estimate.translation() << 5.0, 1.0, 0.0;
  truth.linear() = rotationFromRpy(0.0, 0.0, 1.02);
  truth.translation() << 5.1, 0.8, 0.3;
  Vector6d expected;
  expected << 0.1, -0.2, 0.3, 0.0, 0.0, 0.02;
  EXPECT_LT((motionError(truth, estimate) - expected).norm(), 1e-12);
  EXPECT_EQ(motionError(truth, truth).norm(), 0.0);
}

}  // namespace
}  // namespace fail_aware::consistency_test
