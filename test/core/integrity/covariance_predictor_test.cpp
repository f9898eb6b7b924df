#include "core/integrity/covariance_predictor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "../../support/independent_drift.hpp"
#include "core/estimation/odometry_covariance.hpp"
#include "core/integrity/growth_rate.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::covariance_predictor_test {
namespace {

using Status = TimeToFailureStatus;

CovariancePredictor::Params paramsWith(double confidence, double horizon_s = 60.0, double step_s = 0.25) {
  CovariancePredictor::Params params;
  params.degrees_of_freedom = 0.0;
  params.confidence = params.alarm_confidence = confidence;
  params.horizon_s = horizon_s;
  params.step_s = step_s;
  return params;
}

CovariancePredictor predictorWith(double confidence, double horizon_s = 60.0, double step_s = 0.25) {
  return CovariancePredictor(paramsWith(confidence, horizon_s, step_s));
}

const double kOneSigma = std::erf(std::sqrt(0.5));  // of a normal: an error along a line

TEST(CovariancePredictor, PositionVarianceAloneGrowsLinearly) {
  CovarianceGrowth growth;
  growth.covariance.diagonal() << 0.0, 0.04, 0.0;
  growth.rate.diagonal() << 0.0, 0.02, 0.0;
  growth.speed_mps = 10.0;
  const CovariancePrediction p = predictorWith(kOneSigma).predict(growth);
  EXPECT_NEAR(p.radius_m, 0.2, 1e-12);
  EXPECT_EQ(p.time_to_failure.status, Status::kWithinHorizon);
  EXPECT_NEAR(p.time_to_failure.seconds, (0.36 - 0.04) / 0.02, 1e-9);

  growth.covariance.diagonal() << 0.01, 0.0, 0.0;
  growth.course_rad = M_PI / 2;  // the body's lateral axis is now the mark's x
  EXPECT_NEAR(predictorWith(kOneSigma).predict(growth).time_to_failure.seconds, (0.36 - 0.01) / 0.02, 1e-9);
}

TEST(CovariancePredictor, HeadingErrorReachesTheLimit) {
  CovarianceGrowth growth;
  growth.covariance(2, 2) = 1e-4;  // 0.01 rad
  growth.speed_mps = 8.0;
  growth.course_rad = 0.6;
  const double k = 1.959964;  // a normal's 95 %
  const CovariancePrediction p = predictorWith(0.95).predict(growth);
  EXPECT_EQ(p.radius_m, 0.0);
  EXPECT_NEAR(p.time_to_failure.seconds, 0.6 / (k * 0.01 * 8.0), 1e-4);
  growth.speed_mps = -8.0;
  EXPECT_NEAR(predictorWith(0.95).predict(growth).time_to_failure.seconds, 0.6 / (k * 0.01 * 8.0), 1e-4);
}

TEST(CovariancePredictor, HeadingNoiseGrowsWithTheCubeOfTime) {
  CovarianceGrowth growth;
  growth.rate(2, 2) = 1e-6;
  growth.speed_mps = 20.0;
  // v^2 q t^3 / 3 = 0.36
  const double expected = std::cbrt(3.0 * 0.36 / (400.0 * 1e-6));
  for (const double step : {0.1, 0.25, 3.0}) {
    EXPECT_NEAR(predictorWith(kOneSigma, 60.0, step).predict(growth).time_to_failure.seconds, expected, 1e-6);
  }
}

TEST(CovariancePredictor, AgreesWithCovarianceOnACurve) {
  const double speed = 12.0, yaw_rate = 0.15, dt = 0.02;
  Matrix6d increment = Matrix6d::Zero();
  increment(0, 0) = 1e-3 * dt;
  increment(1, 1) = 5e-4 * dt;
  increment(5, 5) = 4e-6 * dt;
  increment(1, 5) = increment(5, 1) = 1e-5 * dt;
  Vector6d twist = Vector6d::Zero();
  twist[0] = speed;
  twist[5] = yaw_rate;
  OdometryCovariance odometry(independentDrift());
  Pose T = Pose::Identity();
  double crossed_s = -1.0;
  for (int i = 1; i <= 3000 && crossed_s < 0.0; ++i) {
    const Pose next = T * expSe3(dt * twist);
    odometry.propagate(T, next, incrementWith(increment));
    T = next;
    const Eigen::Matrix3d S = horizontalBlock(odometry.covariance());
    if (ConfidenceRadius(kOneSigma)(S.topLeftCorner<2, 2>()) >= 0.6) crossed_s = i * dt;
  }
  ASSERT_GT(crossed_s, 5.0);
  CovarianceGrowth growth;
  growth.rate = horizontalBlock(increment) / dt;
  growth.speed_mps = speed;
  growth.yaw_rate_rps = yaw_rate;
  EXPECT_NEAR(predictorWith(kOneSigma).predict(growth).time_to_failure.seconds, crossed_s, 0.02 * crossed_s);
}

TEST(ConfidenceRadius, LineCircleAndBetween) {
  EXPECT_NEAR(ConfidenceRadius(0.95)(Eigen::Vector2d(4.0, 0.0).asDiagonal()), 2.0 * 1.959964, 1e-4);
  EXPECT_NEAR(ConfidenceRadius(0.95)(Eigen::Vector2d(9.0, 9.0).asDiagonal()), 3.0 * std::sqrt(-2.0 * std::log(0.05)),
              1e-9);
  EXPECT_EQ(ConfidenceRadius(0.95)(Eigen::Matrix2d::Zero()), 0.0);
  const Eigen::Matrix2d R = Eigen::Rotation2Dd(0.7).toRotationMatrix();
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  for (const double ratio : {0.05, 0.3, 0.7}) {
    const Eigen::Matrix2d root = R * Eigen::Vector2d(1.0, ratio).asDiagonal();
    for (const double probability : {0.5, 0.9, 0.99}) {
      const double radius = ConfidenceRadius(probability)(root * root.transpose());
      int inside = 0;
      for (int i = 0; i < 40000; ++i) {
        inside += (root * Eigen::Vector2d(normal(random), normal(random))).norm() <= radius;
      }
      EXPECT_NEAR(inside / 40000.0, probability, 0.01) << ratio;
    }
  }
}

TEST(CovariancePredictor, DriversInClosedForm) {
  CovarianceGrowth bias;
  bias.drivers(0, 0) = 1e-10;  // 1e-5 rad/m: v^2 t^2 / 2 * 1e-5 = 0.6
  bias.speed_mps = 20.0;
  bias.course_rad = 1.1;
  EXPECT_NEAR(predictorWith(kOneSigma).predict(bias).time_to_failure.seconds, std::sqrt(2.0 * 0.6 / 1e-5) / 20.0, 1e-4);
  CovarianceGrowth scale;
  scale.drivers(1, 1) = 1e-6;
  scale.speed_mps = 20.0;
  EXPECT_NEAR(predictorWith(kOneSigma).predict(scale).time_to_failure.seconds, 0.6 / (1e-3 * 20.0), 1e-4);
  CovarianceGrowth lost;
  lost.speed_share = 1.0;
  lost.speed_noise = 0.04;  // 0.04 t^3 / 3 = 0.36
  EXPECT_NEAR(predictorWith(kOneSigma).predict(lost).time_to_failure.seconds, std::cbrt(27.0), 1e-4);
  CovarianceGrowth speed;
  speed.speed_share = 1.0;
  speed.drivers(2, 2) = 0.09;
  EXPECT_NEAR(predictorWith(kOneSigma).predict(speed).time_to_failure.seconds, 2.0, 1e-4);
  speed.speed_share = 0.0;
  EXPECT_EQ(predictorWith(kOneSigma).predict(speed).time_to_failure.status, Status::kBeyondHorizon);
}

// w of steady variance V that is forgotten within T: its way has the variance 2 V T (t - T (1 - e^(-t/T))).
TEST(CovariancePredictor, SpeedErrorThatWandersInClosedForm) {
  constexpr double kForgotten_per_s = 1.6, kSeconds = 9.0, T_s = 1.0 / kForgotten_per_s;
  const double variance = 0.36 / (2.0 * T_s * (kSeconds - T_s * (1.0 - std::exp(-kSeconds / T_s))));
  CovarianceGrowth growth;
  growth.speed_share = 1.0;
  growth.drivers(2, 2) = variance;
  growth.speed_forgotten_per_s = kForgotten_per_s;
  growth.speed_noise = 2.0 * kForgotten_per_s * variance;
  EXPECT_NEAR(predictorWith(kOneSigma).predict(growth).time_to_failure.seconds, kSeconds, 1e-4);
}

TEST(CovariancePredictor, SlowlyForgottenSpeedErrorIsNearlyTheLasting) {
  CovarianceGrowth growth;
  growth.speed_share = 1.0;
  growth.speed_noise = 0.04;
  const double lasting_s = predictorWith(kOneSigma).predict(growth).time_to_failure.seconds;
  for (const double forgotten_per_s : {1e-9, 3.9e-3, 4.1e-3}) {  // 0.25 s: on either side of the series' end
    growth.speed_forgotten_per_s = forgotten_per_s;
    // the way's variance is noise t^3 (1/3 - forgotten t / 4 + ...)
    const double later_s = 0.25 * forgotten_per_s * lasting_s * lasting_s;
    EXPECT_NEAR(predictorWith(kOneSigma).predict(growth).time_to_failure.seconds, lasting_s + later_s, 1e-4);
  }
}

TEST(CovariancePredictor, OnAWeakStretchTheGrowthIsItsOwn) {
  CovarianceGrowth growth;
  growth.speed_mps = 20.0;
  growth.rate(0, 0) = 1e-4;
  EXPECT_EQ(predictorWith(kOneSigma).predict(growth).time_to_failure.status, Status::kBeyondHorizon);
  growth.weak_stretch = CovarianceGrowth::WeakStretch{63.0, 0.0361, 0.5, 0.0, 0.0};
  // 3.15 s to its beginning, between two steps; then 0.36 - 3.15e-4 at 0.0361 a second
  const double expected_s = 3.15 + (0.36 - 3.15e-4) / 0.0361;
  EXPECT_NEAR(predictorWith(kOneSigma).predict(growth).time_to_failure.seconds, expected_s, 1e-4);
  growth.speed_share = 0.6;
  EXPECT_EQ(predictorWith(kOneSigma).predict(growth).time_to_failure.status, Status::kBeyondHorizon)
      << "what is worse now stays";
  growth.speed_share = 0.0;
  growth.speed_mps = 0.0;
  EXPECT_EQ(predictorWith(kOneSigma).predict(growth).time_to_failure.status, Status::kBeyondHorizon) << "never there";
  growth.speed_mps = 20.0;
  growth.weak_stretch = CovarianceGrowth::WeakStretch{0.0, 0.0, 1.0, 0.09, 0.0};
  EXPECT_NEAR(predictorWith(kOneSigma).predict(growth).time_to_failure.seconds, 2.0, 0.05) << "an error of 0.3 m/s";
}

TEST(CovariancePredictor, JitterIsOnTopAndDoesNotGrow) {
  CovarianceGrowth growth;
  growth.transient(1, 1) = 0.16;
  EXPECT_EQ(predictorWith(kOneSigma).predict(growth).time_to_failure.status, Status::kBeyondHorizon);
  EXPECT_NEAR(predictorWith(kOneSigma).predict(growth).radius_m, 0.4, 1e-4);
  growth.rate(1, 1) = 0.02;
  EXPECT_NEAR(predictorWith(kOneSigma).predict(growth).time_to_failure.seconds, 10.0, 1e-3);
}

TEST(CovariancePredictor, StandingStillIsBeyondTheHorizon) {
  CovarianceGrowth growth;
  growth.covariance.diagonal() << 0.01, 0.01, 0.01;
  const CovariancePrediction p = predictorWith(0.95).predict(growth);
  EXPECT_EQ(p.time_to_failure.status, Status::kBeyondHorizon);
  EXPECT_EQ(p.time_to_failure.seconds, 60.0);
  EXPECT_EQ(predictorWith(0.95).predict(CovarianceGrowth()).time_to_failure.status, Status::kBeyondHorizon);
}

TEST(CovariancePredictor, TheLimitsAndTheHorizonsEdges) {
  CovarianceGrowth growth;
  growth.covariance(0, 0) = 0.36 * (1.0 + 1e-12);
  EXPECT_EQ(predictorWith(kOneSigma).predict(growth).time_to_failure.status, Status::kReached);
  EXPECT_EQ(predictorWith(kOneSigma).predict(growth).time_to_failure.seconds, 0.0);
  growth.covariance(0, 0) = 0.36 * (1.0 - 1e-12);
  EXPECT_EQ(predictorWith(kOneSigma).predict(growth).time_to_failure.status, Status::kBeyondHorizon);

  growth.covariance(0, 0) = 0.0;
  growth.rate(0, 0) = 0.036;  // 10 s
  EXPECT_EQ(predictorWith(kOneSigma, 9.999).predict(growth).time_to_failure.status, Status::kBeyondHorizon);
  EXPECT_EQ(predictorWith(kOneSigma, 9.999).predict(growth).time_to_failure.seconds, 9.999);
  EXPECT_EQ(predictorWith(kOneSigma, 10.001).predict(growth).time_to_failure.status, Status::kWithinHorizon);
}

TEST(CovariancePredictor, MoreNoiseNeverGivesMoreTime) {
  CovarianceGrowth growth;
  growth.covariance.diagonal() << 0.001, 0.001, 1e-6;
  growth.rate.diagonal() << 1e-3, 1e-3, 1e-6;
  growth.speed_mps = 10.0;
  double last = 1e9;
  for (const double confidence : {0.3, 0.5, 0.9, 0.99, 0.9999}) {
    const double seconds = predictorWith(confidence).predict(growth).time_to_failure.seconds;
    EXPECT_LT(seconds, last);
    last = seconds;
  }
  const double seconds = predictorWith(0.95).predict(growth).time_to_failure.seconds;
  growth.rate *= 4.0;
  EXPECT_LT(predictorWith(0.95).predict(growth).time_to_failure.seconds, seconds);
}

TEST(CovariancePredictor, UnusableInputBoundsNoError) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CovarianceGrowth good;
  good.rate.diagonal() << 1e-3, 1e-3, 1e-6;
  std::vector<CovarianceGrowth> bad(6, good);
  bad[0].covariance(0, 1) = nan;
  bad[1].rate(2, 2) = -1e-3;
  bad[2].speed_mps = nan;
  bad[3].course_rad = std::numeric_limits<double>::infinity();
  bad[4].yaw_rate_rps = nan;
  bad[5].covariance(0, 1) = bad[5].covariance(1, 0) = 0.1;  // zero variances with correlation
  for (const CovarianceGrowth& growth : bad) {
    const CovariancePrediction p = predictorWith(0.95).predict(growth);
    EXPECT_EQ(p.time_to_failure.status, Status::kReached);
    EXPECT_EQ(p.time_to_alarm.status, Status::kReached);
    EXPECT_EQ(p.radius_m, 1e6);
  }
}

TEST(CovariancePredictor, NeverNan) {
  std::mt19937 random(23);
  std::uniform_int_distribution<int> kind(0, 9);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> exponent(-8.0, 8.0);
  const double strange[] = {std::numeric_limits<double>::quiet_NaN(),
                            std::numeric_limits<double>::infinity(),
                            0.0,
                            -std::numeric_limits<double>::infinity(),
                            1e12,
                            -1e12,
                            1e308};
  const auto number = [&]() {
    return kind(random) == 0 ? strange[kind(random) % 7] : normal(random) * std::pow(10.0, exponent(random));
  };
  const CovariancePredictor predictor = predictorWith(0.95);
  int usable = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    CovarianceGrowth growth;
    const Eigen::Matrix3d A = Eigen::Matrix3d::NullaryExpr([&]() { return 1e-2 * normal(random); });
    growth.covariance = A * A.transpose();
    growth.rate = 0.01 * A.transpose() * A;
    if (kind(random) < 2) growth.covariance(kind(random) % 3, kind(random) % 3) = number();
    if (kind(random) < 2) growth.rate(kind(random) % 3, kind(random) % 3) = number();
    growth.speed_mps = number();
    growth.course_rad = number();
    growth.yaw_rate_rps = number();
    const CovariancePrediction p = predictor.predict(growth);
    const double seconds = p.time_to_failure.seconds;
    ASSERT_TRUE(p.time_to_failure.isKnown());
    ASSERT_TRUE(seconds >= 0.0 && seconds <= 60.0) << seconds;
    ASSERT_TRUE(p.radius_m >= 0.0 && p.radius_m <= 1e6) << p.radius_m;
    usable += p.radius_m < 1e6;
  }
  EXPECT_GT(usable, 300);
}

TEST(IncrementRate, AveragesOverItsWindowPerSecond) {
  IncrementRate rate(1.0);
  EXPECT_FALSE(rate.rate());
  Matrix6d small = Matrix6d::Zero();
  small(0, 0) = 0.01;
  small(1, 5) = small(5, 1) = 0.001;
  small(1, 1) = small(5, 5) = 0.002;
  EXPECT_TRUE(rate.update(small, 0.125, false));
  EXPECT_NEAR((*rate.rate())(0, 0), 0.08, 1e-15);
  EXPECT_NEAR((*rate.rate())(1, 2), 0.008, 1e-15);
  for (int i = 0; i < 8; ++i) EXPECT_TRUE(rate.update(3.0 * small, 0.125, false));
  EXPECT_NEAR((*rate.rate())(0, 0), 0.24, 1e-12);  // the first one has left
  EXPECT_TRUE(rate.update(small, 4.0, false));     // longer than the window: alone
  EXPECT_NEAR((*rate.rate())(0, 0), 0.0025, 1e-15);
  EXPECT_FALSE(rate.update(small, 0.0, false));
  EXPECT_FALSE(rate.update(small, std::numeric_limits<double>::quiet_NaN(), false));
  EXPECT_FALSE(rate.update(-small, 0.1, false));
  EXPECT_NEAR((*rate.rate())(0, 0), 0.0025, 1e-15);
  rate.reset();
  EXPECT_FALSE(rate.rate());
}

TEST(CovariancePredictor, TheAlarmComesWithItsOwnConfidence) {
  CovarianceGrowth growth;
  growth.rate.diagonal() << 1e-3, 1e-3, 1e-6;
  growth.speed_mps = 10.0;
  CovariancePredictor::Params params;
  params.degrees_of_freedom = 0.0;
  params.confidence = 0.95;
  params.alarm_confidence = 0.7;
  const CovariancePredictor both(params);
  const CovariancePrediction p = both.predict(growth);
  EXPECT_NEAR(p.time_to_failure.seconds, predictorWith(0.95).predict(growth).time_to_failure.seconds, 1e-9);
  EXPECT_NEAR(p.time_to_alarm.seconds, predictorWith(0.7).predict(growth).time_to_failure.seconds, 1e-9);
  EXPECT_GT(p.time_to_alarm.seconds, p.time_to_failure.seconds);
  growth.covariance(0, 0) = 0.15;  // 0.387 m: past the limit with 0.95, not with 0.7
  EXPECT_GE(both.predict(growth).radius_m, params.alert_limit_m);
  EXPECT_EQ(both.predict(growth).time_to_alarm.status, Status::kWithinHorizon);
  growth.covariance(0, 0) = 1.0;
  EXPECT_EQ(both.predict(growth).time_to_alarm.status, Status::kReached);
  EXPECT_EQ(both.predict(growth).time_to_failure.status, Status::kReached);
  params.alarm_confidence = 0.96;
  EXPECT_THROW(validate(params), ParameterError);
}

TEST(CovariancePredictor, TimeIsConditionedOnSurvival) {
  CovarianceGrowth growth;  // along a line: P(|e| > 0.6) = 2 (1 - Phi(0.6 / sigma))
  growth.covariance(0, 0) = 0.09;
  growth.rate(0, 0) = 0.02;
  CovariancePredictor::Params params;
  params.degrees_of_freedom = 0.0;
  params.confidence = 0.9;
  params.alarm_confidence = 0.5;
  const CovariancePrediction p = CovariancePredictor(params).predict(growth);
  const auto failed = [](double variance) { return std::erfc(0.6 / std::sqrt(2.0 * variance)); };
  const double now = failed(0.09);
  const double then = failed(0.09 + 0.02 * p.time_to_failure.seconds);
  EXPECT_NEAR((then - now) / (1.0 - now), 0.1, 1e-3);
  EXPECT_NEAR(failed(0.09 + 0.02 * p.time_to_alarm.seconds), 0.5, 2e-3);
}

TEST(Exceedance, OfACircleALineAndNothing) {
  EXPECT_NEAR(exceedance(Eigen::Vector2d(4.0, 4.0).asDiagonal(), 3.0), std::exp(-9.0 / 8.0), 1e-12);
  EXPECT_NEAR(exceedance(Eigen::Vector2d(4.0, 0.0).asDiagonal(), 3.0), std::erfc(1.5 / std::sqrt(2.0)), 1e-3);
  EXPECT_EQ(exceedance(Eigen::Matrix2d::Zero(), 0.1), 0.0);
}

TEST(Exceedance, StudentsTailsAreLonger) {
  // of a circle (1 + r^2 / n)^(-n / 2); of a line the two-sided quantiles of Student's t, from tables
  EXPECT_NEAR(exceedance(Eigen::Matrix2d::Identity(), 2.0, 5.0), std::pow(1.8, -2.5), 1e-12);
  const Eigen::Matrix2d line = Eigen::Vector2d(1.0, 0.0).asDiagonal();
  EXPECT_NEAR(exceedance(line, 2.570582, 5.0), 0.05, 1e-3);
  EXPECT_NEAR(ConfidenceRadius(0.95, 5.0)(line), 2.570582, 0.02);
  const double circle = ConfidenceRadius(0.9, 5.0)(Eigen::Matrix2d::Identity());
  EXPECT_NEAR(std::pow(1.0 + circle * circle / 5.0, -2.5), 0.1, 1e-9);
  EXPECT_NEAR(exceedance(Eigen::Matrix2d::Identity(), 2.0, 1e5), exceedance(Eigen::Matrix2d::Identity(), 2.0), 1e-4);
}

TEST(Exceedance, BoundIsAboveAndTightForACircle) {
  for (const double degrees_of_freedom : {0.0, 3.0, 8.0}) {
    for (const double smaller : {0.0, 0.01, 0.3, 1.0, 4.0}) {
      const Eigen::Matrix2d covariance =
          Eigen::Rotation2Dd(0.7) * Eigen::Vector2d(4.0, smaller).asDiagonal() * Eigen::Rotation2Dd(-0.7);
      for (const double radius : {0.1, 1.0, 3.0, 10.0, 60.0}) {
        EXPECT_GE(exceedanceBound(covariance, radius, degrees_of_freedom),
                  exceedance(covariance, radius, degrees_of_freedom));
      }
    }
    const Eigen::Matrix2d circle = 4.0 * Eigen::Matrix2d::Identity();
    EXPECT_NEAR(exceedanceBound(circle, 3.0, degrees_of_freedom), exceedance(circle, 3.0, degrees_of_freedom), 1e-11);
  }
  EXPECT_EQ(exceedanceBound(Eigen::Matrix2d::Zero(), 0.1), 0.0);
}

TEST(CovariancePredictor, ParametersAreChecked) {
  CovariancePredictor::Params tails;
  for (const double wrong : {-1.0, 0.01, 1e7, std::nan("")}) {
    tails.degrees_of_freedom = wrong;
    EXPECT_THROW(validate(tails), ParameterError) << wrong;
  }
  EXPECT_THROW(validate(paramsWith(1.0)), ParameterError);
  EXPECT_THROW(validate(paramsWith(0.0)), ParameterError);
  EXPECT_THROW(validate(paramsWith(0.95, 60.0, 1e-6)), ParameterError);
}

}  // namespace
}  // namespace fail_aware::covariance_predictor_test
