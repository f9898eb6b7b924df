#include "core/estimation/ukf.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "../../support/random_orthogonal.hpp"
#include "core/geometry/decompositions.hpp"
#include "core/geometry/rotation.hpp"

namespace fail_aware::ukf_test {
namespace {

Matrix6d randomCovariance(std::mt19937& random, double log10_low, double log10_high) {
  std::uniform_real_distribution<double> exponent(log10_low, log10_high);
  const Matrix6d Q = randomOrthogonal(random);
  Vector6d variances;
  for (int i = 0; i < 6; ++i) variances[i] = std::pow(10.0, exponent(random));
  const Matrix6d C = Q * variances.asDiagonal() * Q.transpose();
  return 0.5 * (C + C.transpose());
}

void expectSymmetricPositiveDefinite(const Matrix6d& P) {
  ASSERT_TRUE(P.allFinite());
  ASSERT_EQ((P - P.transpose()).cwiseAbs().maxCoeff(), 0.0);
  ASSERT_GT(symmetricEigenvalues(P)[0], 0.0);
}

// The state before the step stays as uncertain as it was.
TEST(Ukf, AMotionReducesTheStepsNoiseOnly) {
  Ukf ukf;
  ASSERT_TRUE(ukf.reset(Vector6d::Zero(), Matrix6d::Identity()));
  const Matrix6d Q = 0.04 * Matrix6d::Identity();
  ASSERT_TRUE(ukf.predict([](const Vector6d& x) { return x; }, Q));
  const Vector6d z = 0.1 * Vector6d::Unit(0);
  ASSERT_TRUE(ukf.correctMotion(z, Q));
  EXPECT_NEAR(ukf.state()[0], 0.05, 1e-9);
  EXPECT_NEAR(ukf.covariance()(0, 0), 1.02, 1e-6);
  EXPECT_NEAR(ukf.motionNoise()(0, 0), 0.02, 1e-9);
  ASSERT_TRUE(ukf.reset(Vector6d::Zero(), Matrix6d::Identity()));
  ASSERT_TRUE(ukf.correctMotion(z, Q));
  EXPECT_EQ(ukf.state()[0], 0.0) << "no step was predicted";
  EXPECT_FALSE(ukf.correctMotion(Vector6d::Constant(std::numeric_limits<double>::quiet_NaN()), Q));
}

TEST(Ukf, EqualsTheClosedFormKalmanFilterOnALinearCase) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Matrix6d F = Matrix6d::Identity();
  F(0, 1) = 0.1;
  F(1, 0) = -0.1;
  F(2, 4) = 0.3;
  F(5, 3) = 0.05;
  F(4, 4) = 0.9;
  Vector6d shift;
  shift << 1.0, 0.5, 0.0, 0.001, -0.002, 0.003;

  Ukf ukf;
  Vector6d x = Vector6d::Zero();
  Matrix6d P = 0.01 * randomCovariance(random, -1.0, 0.0);
  ASSERT_TRUE(ukf.reset(x, P));
  for (int step = 0; step < 200; ++step) {
    const Matrix6d Q = 0.01 * randomCovariance(random, -3.0, -1.0);
    const Matrix6d R = 0.01 * randomCovariance(random, -2.0, 1.0);
    ASSERT_TRUE(ukf.predict([&](const Vector6d& s) { return Vector6d(F * s + shift); }, Q));
    x = F * x + shift;
    P = F * P * F.transpose() + Q;
    Vector6d z = x;
    for (int i = 0; i < 6; ++i) z[i] += 0.05 * normal(random);
    ASSERT_TRUE(ukf.correct(z, R));
    const Matrix6d S = P + R;
    const Matrix6d S_inverse = inverseOf(S);
    const Matrix6d K = P * S_inverse;
    EXPECT_NEAR(ukf.nis(), (z - x).dot(S_inverse * (z - x)), 1e-6);
    x += K * (z - x);
    P = (Matrix6d::Identity() - K) * P;
    ASSERT_LT((ukf.state() - x).norm(), 1e-8) << step;
    ASSERT_LT((ukf.covariance() - P).norm(), 1e-8 * P.norm()) << step;
  }
}

TEST(Ukf, YawCrossesPiBothWays) {
  for (const double side : {1.0, -1.0}) {
    Ukf ukf;
    Vector6d x = Vector6d::Zero();
    x[5] = side * (M_PI - 0.01);
    ASSERT_TRUE(ukf.reset(x, 1e-4 * Matrix6d::Identity()));
    ASSERT_TRUE(ukf.predict(
        [&](const Vector6d& s) {
          Vector6d out = s;
          out[5] = wrapAngle(s[5] + side * 0.02);
          return out;
        },
        1e-4 * Matrix6d::Identity()));
    EXPECT_NEAR(ukf.state()[5], side * (-M_PI + 0.01), 1e-9);
    EXPECT_NEAR(ukf.covariance()(5, 5), 2e-4, 1e-9);
    Vector6d z = Vector6d::Zero();
    z[5] = side * (M_PI - 0.01);  // across the seam from the state, 0.02 rad away
    ASSERT_TRUE(ukf.correct(z, 2e-4 * Matrix6d::Identity()));
    EXPECT_NEAR(ukf.nis(), 0.02 * 0.02 / 4e-4, 1e-6);
    EXPECT_NEAR(std::abs(ukf.state()[5]), M_PI, 1e-9);
    EXPECT_GE(ukf.state()[5], -M_PI);
    EXPECT_LT(ukf.state()[5], M_PI);
  }
}

TEST(Ukf, CovarianceStaysPositiveDefiniteOverTenThousandSteps) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  Ukf ukf;
  ASSERT_TRUE(ukf.reset(Vector6d::Zero(), 0.01 * Matrix6d::Identity()));
  Vector6d variances;
  variances << 0.0024, 0.0019, 0.0146, 0.0212, 0.0212, 1.9e-5;
  const Matrix6d Q = variances.asDiagonal();
  const auto drive = [](const Vector6d& s) {
    Vector6d out = s;
    out.head<3>() += rotationFromRpy(s[3], s[4], s[5]) * Eigen::Vector3d(1.5, 0.0, 0.0);
    out[5] = wrapAngle(s[5] + 0.02);
    return out;
  };
  for (int step = 0; step < 10000; ++step) {
    ASSERT_TRUE(ukf.predict(drive, step % 7 == 0 ? Matrix6d(Matrix6d::Zero()) : Q));
    expectSymmetricPositiveDefinite(ukf.covariance());
    if (step % 5 == 4) continue;  // a sweep without measurement
    Matrix6d R = step % 11 == 0 ? Matrix6d(Matrix6d::Zero()) : randomCovariance(random, -12.0, 6.0);
    Vector6d z = ukf.state();
    for (int i = 0; i < 6; ++i) z[i] += 0.02 * normal(random);
    ASSERT_TRUE(ukf.correct(z, R)) << step;
    expectSymmetricPositiveDefinite(ukf.covariance());
    ASSERT_TRUE(ukf.state().allFinite());
    ASSERT_TRUE(std::isfinite(ukf.nis()));
  }
}

TEST(Ukf, AnUnobservedDirectionStaysWhereItWas) {
  Ukf ukf;
  ASSERT_TRUE(ukf.reset(Vector6d::Zero(), 0.04 * Matrix6d::Identity()));
  const Eigen::Vector2d weak(std::cos(0.6), std::sin(0.6));
  Matrix6d R = 1e-4 * Matrix6d::Identity();
  R.topLeftCorner<2, 2>() += 1e6 * weak * weak.transpose();
  Vector6d z = Vector6d::Zero();
  z.head<2>() << 3.0, -1.0;
  ASSERT_TRUE(ukf.correct(z, R));
  EXPECT_NEAR(ukf.state().head<2>().dot(weak), 0.0, 1e-5);
  const Eigen::Vector2d strong(-weak.y(), weak.x());
  EXPECT_NEAR(ukf.state().head<2>().dot(strong), z.head<2>().dot(strong) * 0.04 / 0.0401, 1e-5);
  EXPECT_NEAR(weak.dot(ukf.covariance().topLeftCorner<2, 2>() * weak), 0.04, 1e-6);
  EXPECT_NEAR(strong.dot(ukf.covariance().topLeftCorner<2, 2>() * strong), 0.04 * 1e-4 / 0.0401, 1e-7);
}

TEST(Ukf, APerfectMeasurementIsTakenOver) {
  Ukf ukf;
  ASSERT_TRUE(ukf.reset(Vector6d::Zero(), Matrix6d::Identity()));
  Vector6d z;
  z << 1.0, 2.0, 3.0, 0.1, 0.2, 0.3;
  ASSERT_TRUE(ukf.correct(z, Matrix6d::Zero()));
  EXPECT_LT((ukf.state() - z).norm(), 1e-12);
  expectSymmetricPositiveDefinite(ukf.covariance());
  EXPECT_NEAR(ukf.nis(), z.squaredNorm(), 1e-9);
}

TEST(Ukf, RefusesWhatItCannotUseAndStaysAsItWas) {
  Ukf ukf;
  ASSERT_TRUE(ukf.reset(Vector6d::Ones() * 0.1, 0.01 * Matrix6d::Identity()));
  const Vector6d state = ukf.state();
  const Matrix6d covariance = ukf.covariance();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto stand = [](const Vector6d& s) { return s; };

  Vector6d bad_z = state;
  bad_z[2] = nan;
  Matrix6d bad_R = Matrix6d::Identity();
  bad_R(3, 3) = std::numeric_limits<double>::infinity();
  Matrix6d negative_R = Matrix6d::Identity();
  negative_R(0, 0) = -1.0;
  EXPECT_FALSE(ukf.correct(bad_z, Matrix6d::Identity()));
  EXPECT_FALSE(ukf.correct(state, bad_R));
  EXPECT_FALSE(ukf.correct(state, negative_R));
  EXPECT_FALSE(ukf.predict(stand, bad_R));
  EXPECT_FALSE(ukf.predict(stand, negative_R));
  EXPECT_FALSE(ukf.predict([&](const Vector6d&) { return Vector6d(Vector6d::Constant(nan)); }, covariance));
  EXPECT_FALSE(ukf.reset(bad_z, covariance));
  EXPECT_EQ(ukf.state(), state);
  EXPECT_EQ(ukf.covariance(), covariance);
  EXPECT_EQ(ukf.nis(), 0.0);
}

}  // namespace
}  // namespace fail_aware::ukf_test
