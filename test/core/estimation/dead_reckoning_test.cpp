#include "core/estimation/dead_reckoning.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

#include "../../support/independent_drift.hpp"
#include "core/estimation/odometry_covariance.hpp"
#include "core/geometry/degree.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::dead_reckoning_test {
namespace {

constexpr double kDt_s = 0.1;

DeadReckoning::Measured measured(double speed_mps, double sigma_along_m, double yaw_rate_rad_s = 0.0,
                                 double sigma_yaw_rad = 1e-3) {
  DeadReckoning::Measured m;
  m.velocity_mps.x() = speed_mps;
  m.yaw_rate_rad_s = yaw_rate_rad_s;
  m.R = Eigen::Vector3d(sigma_along_m, 0.01, 0.01).cwiseAbs2().asDiagonal();
  m.yaw_variance = sigma_yaw_rad * sigma_yaw_rad;
  return m;
}

/// The map does not observe the road's direction; a source of kind kMotion does.
DeadReckoning::Measured measuredByMotion(double speed_mps, double sigma_along_m) {
  DeadReckoning::Measured m = measured(speed_mps, 100.0);
  m.motion = {speed_mps * Eigen::Vector3d::UnitX(),
              Eigen::Vector3d(sigma_along_m, 100.0, 100.0).cwiseAbs2().asDiagonal()};
  return m;
}

MotionDerivatives motionOf(double speed_mps) {
  MotionDerivatives motion;
  motion.velocity_body_mps.x() = speed_mps;
  return motion;
}

void observe(DeadReckoning& dead_reckoning, const DeadReckoning::Measured& m) {
  for (int i = 0; i < DeadReckoning::Params().observed_sweeps; ++i) dead_reckoning.filter(motionOf(10.0), kDt_s, &m);
}

DeadReckoning lastObserved(double sigma_m = 0.01) {
  DeadReckoning dead_reckoning{DeadReckoning::Params()};
  dead_reckoning.reset({0.3, 0.1, 0.1}, 0.02);
  observe(dead_reckoning, measured(10.0, sigma_m));
  return dead_reckoning;
}

TEST(DeadReckoning, AMotionCorrectsTheSpeedAndDoesNotEndIt) {
  DeadReckoning dead_reckoning{DeadReckoning::Params()};
  dead_reckoning.reset(Eigen::Vector3d::Constant(1.0), 0.1);
  const DeadReckoning::Measured by_motion = measuredByMotion(11.0, 0.1);
  EXPECT_FALSE(dead_reckoning.observes(by_motion));
  const MotionDerivatives motion = dead_reckoning.filter(motionOf(10.0), kDt_s, &by_motion);
  EXPECT_NEAR(motion.velocity_body_mps.x(), 10.0 + 1.0 / 3.0, 0.01) << "sigma 1 m/s against 1 m/s, counted twice";
  observe(dead_reckoning, by_motion);
  EXPECT_TRUE(dead_reckoning.active());
  observe(dead_reckoning, measured(10.0, 0.04));
  EXPECT_FALSE(dead_reckoning.active());
}

TEST(DeadReckoning, ObservesRoadAndHeading) {
  const DeadReckoning dead_reckoning{DeadReckoning::Params()};
  EXPECT_TRUE(dead_reckoning.observes(measured(1.0, 0.049)));
  EXPECT_FALSE(dead_reckoning.observes(measured(1.0, 0.051)));
  EXPECT_TRUE(dead_reckoning.observes(measured(1.0, 0.01, 0.0, 0.14 * kDegree)));
  EXPECT_FALSE(dead_reckoning.observes(measured(1.0, 0.01, 0.0, 0.16 * kDegree)));
  DeadReckoning::Measured high = measured(1.0, 0.01);
  high.R(2, 2) = 100.0;
  EXPECT_TRUE(dead_reckoning.observes(high)) << "height does not matter";
}

// Poses that are 4 cm off give a speed that is 0.6 m/s off; what the vehicle can do says more.
TEST(DeadReckoning, AnObservedButUnsureSpeedIsFilteredAndNotDeadReckoned) {
  DeadReckoning dead_reckoning = lastObserved();
  const DeadReckoning::Measured unsure = measured(14.0, 0.04);
  EXPECT_TRUE(dead_reckoning.observes(unsure));
  EXPECT_EQ(dead_reckoning.sureness(unsure), 0.0);
  EXPECT_NEAR(dead_reckoning.sureness(measured(14.0, 0.03)), 0.5, 1e-9);
  EXPECT_EQ(dead_reckoning.sureness(measured(14.0, 0.01)), 1.0);
  const MotionDerivatives motion = dead_reckoning.filter(motionOf(10.0), kDt_s, &unsure);
  EXPECT_FALSE(dead_reckoning.active());
  EXPECT_EQ(dead_reckoning.speedError().variance_m2_s2, 0.0);
  EXPECT_TRUE(dead_reckoning.incrementCovariance(kDt_s).isZero());
  EXPECT_GT(motion.velocity_body_mps.x(), 10.01);
  EXPECT_LT(motion.velocity_body_mps.x(), 10.5) << "of 4 m/s in a tenth of a second";

  const DeadReckoning::Measured useless = measured(14.0, 3.0);
  dead_reckoning.filter(motionOf(10.0), kDt_s, &useless);
  EXPECT_TRUE(dead_reckoning.active());
  for (int i = 0; i < DeadReckoning::Params().observed_sweeps; ++i) {
    EXPECT_TRUE(dead_reckoning.active()) << i;
    dead_reckoning.filter(motionOf(10.0), kDt_s, &unsure);
  }
  EXPECT_FALSE(dead_reckoning.active());
}

TEST(DeadReckoning, InTheFirstSweepsOfADriveThePosesGiveTheSpeed) {
  DeadReckoning dead_reckoning{DeadReckoning::Params()};
  const DeadReckoning::Measured unsure = measured(10.0, 0.045);
  for (int i = 1; i < DeadReckoning::Params().observed_sweeps; ++i) {
    dead_reckoning.filter(motionOf(10.0), kDt_s, &unsure);
    EXPECT_EQ(dead_reckoning.sureness(unsure), 1.0) << i;
  }
  dead_reckoning.filter(motionOf(10.0), kDt_s, &unsure);
  EXPECT_EQ(dead_reckoning.sureness(unsure), 0.0);
}

TEST(DeadReckoning, KeepsTheSpeedThatNothingObserves) {
  DeadReckoning dead_reckoning = lastObserved();
  EXPECT_FALSE(dead_reckoning.active());
  EXPECT_TRUE(dead_reckoning.incrementCovariance(kDt_s).isZero());
  MotionDerivatives motion = motionOf(10.0);
  const DeadReckoning::Measured stands = measured(0.0, 30.0);
  for (int i = 0; i < 200; ++i) {
    motion = dead_reckoning.filter(motion, kDt_s, i % 2 == 0 ? &stands : nullptr);
    ASSERT_NEAR(motion.velocity_body_mps.x(), 10.0, 1e-9) << i;
  }
  EXPECT_TRUE(dead_reckoning.active());
  observe(dead_reckoning, measured(10.0, 0.01));
  EXPECT_FALSE(dead_reckoning.active());
  EXPECT_EQ(dead_reckoning.speedError().variance_m2_s2, 0.0);
}

TEST(DeadReckoning, OneSurePoseBetweenUnsureOnesDoesNotEndIt) {
  DeadReckoning dead_reckoning = lastObserved();
  const DeadReckoning::Measured sure = measured(10.0, 0.01), unsure = measured(10.0, 3.0);
  const int needed = DeadReckoning::Params().observed_sweeps;
  for (int round = 0; round < 2; ++round) {
    dead_reckoning.filter(motionOf(10.0), kDt_s, &unsure);
    EXPECT_TRUE(dead_reckoning.active());
    for (int i = 0; i < needed - 1; ++i) {
      dead_reckoning.filter(motionOf(10.0), kDt_s, &sure);
      EXPECT_TRUE(dead_reckoning.active()) << i;
    }
  }
  dead_reckoning.filter(motionOf(10.0), kDt_s, &sure);
  EXPECT_FALSE(dead_reckoning.active());
}

TEST(DeadReckoning, AnAccelerationThatNothingObservesDiesOut) {
  DeadReckoning dead_reckoning = lastObserved();
  MotionDerivatives motion = motionOf(10.0);
  motion.acceleration_body_mps2.x() = 1.0;
  for (int i = 0; i < 100; ++i) motion = dead_reckoning.filter(motion, kDt_s, nullptr);
  EXPECT_NEAR(motion.velocity_body_mps.x(), 10.0 + 1.5, 0.1) << "acceleration times its correlation time";
  EXPECT_NEAR(motion.acceleration_body_mps2.x(), 0.0, 0.01);
}

TEST(DeadReckoning, AVehicleThatBrakesDoesNotReverse) {
  for (const double direction : {1.0, -1.0}) {
    DeadReckoning dead_reckoning = lastObserved();
    MotionDerivatives motion = motionOf(direction * 5.0);
    motion.acceleration_body_mps2.x() = -direction * 5.0;
    for (int i = 0; i < 30; ++i) {
      motion = dead_reckoning.filter(motion, kDt_s, nullptr);
      ASSERT_GE(direction * motion.velocity_body_mps.x(), 0.0) << i;
    }
    EXPECT_LT(std::abs(motion.velocity_body_mps.x()), 0.5);
    EXPECT_EQ(motion.acceleration_body_mps2.x(), 0.0);
  }
}

TEST(DeadReckoning, AtACrawlNoBrakingGoesOn) {
  DeadReckoning dead_reckoning = lastObserved();
  MotionDerivatives motion = motionOf(-0.05);  // stands, as the last sweep measured it
  motion.acceleration_body_mps2.x() = -7.0;
  for (int i = 0; i < 30; ++i) motion = dead_reckoning.filter(motion, kDt_s, nullptr);
  EXPECT_DOUBLE_EQ(motion.velocity_body_mps.x(), -0.05);
}

TEST(DeadReckoning, WhatTakesBackAPositionsErrorIsNoSpeed) {
  DeadReckoning after_a_second = lastObserved();
  const DeadReckoning::Measured useless = measured(10.0, 3.0);
  for (int i = 0; i < 10; ++i) after_a_second.filter(motionOf(10.0), kDt_s, &useless);
  const auto speedWith = [&](double previous_sigma_m, double sigma_m = 0.015) {
    DeadReckoning dead_reckoning = after_a_second;
    DeadReckoning::Measured found = measured(11.0, sigma_m);  // 0.1 m ahead of what was predicted
    found.P_previous(0, 0) = previous_sigma_m * previous_sigma_m;
    return dead_reckoning.filter(motionOf(10.0), kDt_s, &found).velocity_body_mps.x();
  };
  EXPECT_LT(speedWith(0.1), 10.3);
  EXPECT_GT(speedWith(0.015), 10.6);
  EXPECT_EQ(speedWith(0.015), speedWith(0.0)) << "the last estimate is as uncertain as R at least";
  EXPECT_LT(speedWith(0.1, 0.06), speedWith(0.0, 0.06));
}

TEST(DeadReckoning, FollowsAnUnsureSpeedThatChanges) {
  DeadReckoning dead_reckoning = lastObserved();
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  MotionDerivatives motion = motionOf(10.0);
  const double sigma_m = 0.08;
  for (int i = 1; i <= 80; ++i) {
    const double true_mps = 10.0 + 1.5 * i * kDt_s;
    const DeadReckoning::Measured m = measured(true_mps + std::sqrt(2.0) * sigma_m / kDt_s * normal(random), sigma_m);
    motion = dead_reckoning.filter(motion, kDt_s, &m);
    if (i > 30) {
      ASSERT_NEAR(motion.velocity_body_mps.x(), true_mps, 1.5) << i;
    }
  }
  EXPECT_LT(std::sqrt(dead_reckoning.speedError().variance_m2_s2), 0.7);
  EXPECT_NEAR(motion.acceleration_body_mps2.x(), 1.5, 0.8);
}

TEST(DeadReckoning, AnUnknownSpeedTakesTheFirstMeasurement) {
  DeadReckoning dead_reckoning{DeadReckoning::Params()};
  dead_reckoning.reset({15.0, 0.0, 0.0}, 0.0);
  const DeadReckoning::Measured nothing = measured(0.0, 3.0), found = measured(20.0, 0.05, 0.0, 0.01);
  MotionDerivatives motion = motionOf(0.0);
  for (int i = 0; i < 50; ++i) motion = dead_reckoning.filter(motion, kDt_s, &nothing);
  EXPECT_EQ(motion.velocity_body_mps.x(), 0.0);
  EXPECT_GT(std::sqrt(dead_reckoning.speedError().variance_m2_s2), 15.0) << "not a confident standstill";
  motion = dead_reckoning.filter(motion, kDt_s, &found);
  EXPECT_NEAR(motion.velocity_body_mps.x(), 20.0, 0.2);
}

TEST(DeadReckoning, TheAccumulatedVarianceIsThatOfAContinuedError) {
  // a constant velocity error of sigma: the position's variance is (sigma t)^2
  DeadReckoning::Params params;
  params.acceleration_mps2 = 0.0;
  DeadReckoning dead_reckoning(params);
  const double sigma_mps = 0.3;
  dead_reckoning.reset({sigma_mps, 0.0, 0.0}, 0.0);
  OdometryCovariance accumulated(independentDrift());
  OdometryIncrement increment;
  increment.dt_s = kDt_s;
  Pose T = Pose::Identity();
  const int sweeps = 50;
  for (int i = 0; i < sweeps; ++i) {
    dead_reckoning.filter(motionOf(10.0), kDt_s, nullptr);
    Pose next = T;
    next.translation().x() += 1.0;
    increment.speed_error = dead_reckoning.speedError();
    ASSERT_TRUE(accumulated.propagate(T, next, increment));
    T = next;
  }
  EXPECT_NEAR(std::sqrt(accumulated.covariance()(0, 0)), sigma_mps * (sweeps - 1) * kDt_s, 1e-4);
}

TEST(DeadReckoning, AMeasuredSpeedForgetsTheErrorBefore) {
  DeadReckoning dead_reckoning = lastObserved();
  dead_reckoning.filter(motionOf(10.0), kDt_s, nullptr);
  const DeadReckoning::Measured unsure = measured(10.0, 0.1), useless = measured(10.0, 3.0);
  dead_reckoning.filter(motionOf(10.0), kDt_s, &useless);
  EXPECT_EQ(dead_reckoning.speedError().kept, 1.0);
  DeadReckoning unmeasured = dead_reckoning;
  unmeasured.filter(motionOf(10.0), kDt_s, nullptr);
  dead_reckoning.filter(motionOf(10.0), kDt_s, &unsure);
  // a scalar Kalman step: P+ = kept P-
  EXPECT_LT(dead_reckoning.speedError().kept, 1.0);
  EXPECT_GT(dead_reckoning.speedError().kept, 0.5);
  EXPECT_NEAR(dead_reckoning.speedError().variance_m2_s2,
              dead_reckoning.speedError().kept * unmeasured.speedError().variance_m2_s2, 1e-12);
}

TEST(DeadReckoning, TheYawRateCoastsLikewise) {
  DeadReckoning dead_reckoning = lastObserved();
  MotionDerivatives motion = motionOf(10.0);
  motion.rpy_rates_rad_s.z() = 0.2;
  const DeadReckoning::Measured useless = measured(10.0, 0.01, -3.0, 0.1), unsure = measured(10.0, 0.01, 0.3, 0.005);
  for (int i = 0; i < 20; ++i) {
    motion = dead_reckoning.filter(motion, kDt_s, &useless);
    ASSERT_NEAR(motion.rpy_rates_rad_s.z(), 0.2, 1e-12);
  }
  for (int i = 0; i < 100; ++i) motion = dead_reckoning.filter(motion, kDt_s, &unsure);
  EXPECT_NEAR(motion.rpy_rates_rad_s.z(), 0.3, 0.02);
}

// Measured turns that come and go are noise at 25 m/s and may be bends at 5 m/s.
TEST(DeadReckoning, TheFasterTheSlowerItBelievesInATurn) {
  double largest_rad_s[2] = {0.0, 0.0};
  for (const bool fast : {false, true}) {
    DeadReckoning dead_reckoning = lastObserved();
    MotionDerivatives motion = motionOf(fast ? 25.0 : 5.0);
    for (int i = 0; i < 100; ++i) {
      DeadReckoning::Measured turning =
          measured(motion.velocity_body_mps.x(), 0.01, i / 10 % 2 == 0 ? 0.3 : -0.3, 0.01);
      motion = dead_reckoning.filter(motion, kDt_s, &turning);
      if (i >= 20) largest_rad_s[fast] = std::max(largest_rad_s[fast], std::abs(motion.rpy_rates_rad_s.z()));
    }
  }
  EXPECT_GT(largest_rad_s[false], 0.25);
  EXPECT_LT(largest_rad_s[true], 0.5 * largest_rad_s[false]);
}

TEST(DeadReckoning, ParametersAreChecked) {
  DeadReckoning::Params params;
  params.acceleration_mps2 = -1.0;
  EXPECT_THROW(validate(params), ParameterError);
}

TEST(DeadReckoning, LongIntervalAllowsAccelerations) {
  const DeadReckoning dead_reckoning{DeadReckoning::Params()};
  const DeadReckoning::Params params;
  // the speed of 0.75 * 0.2 s ago, and 0.4 s in which it changes further
  const double lever_s2 = (0.75 * 0.2 + 0.5 * 0.4) * 0.4;
  const Eigen::Matrix4d slow = dead_reckoning.drivenCovariance(0.4, 0.2, 5.0);
  EXPECT_NEAR(std::sqrt(slow(0, 0)), params.acceleration_mps2 * lever_s2, 1e-12);
  EXPECT_NEAR(std::sqrt(slow(3, 3)), params.yaw_acceleration_rad_s2 * lever_s2, 1e-12);
  EXPECT_NEAR(std::sqrt(slow(1, 1)), 5.0 * 0.4 * std::sqrt(slow(3, 3)) / 3.0, 1e-12);
  EXPECT_DOUBLE_EQ(slow(2, 2), 0.0);
  // at twice the turning speed bends are four times as wide
  const Eigen::Matrix4d fast = dead_reckoning.drivenCovariance(0.4, 0.2, 2.0 * params.turning_speed_mps);
  EXPECT_NEAR(std::sqrt(fast(3, 3)), 0.25 * std::sqrt(slow(3, 3)), 1e-12);
  EXPECT_DOUBLE_EQ(fast(0, 0), slow(0, 0));
  const Eigen::Matrix4d forever = dead_reckoning.drivenCovariance(100.0, 100.0, 5.0);
  EXPECT_DOUBLE_EQ(std::sqrt(forever(3, 3)), 0.25);
  EXPECT_TRUE(forever.isApprox(dead_reckoning.drivenCovariance(3.0, 3.0, 5.0)));
}

TEST(DeadReckoning, AMeanOverAGapDoesNotObserveTheMotion) {
  const DeadReckoning dead_reckoning{DeadReckoning::Params()};
  DeadReckoning::Measured measured;
  measured.velocity_mps.x() = 10.0;
  measured.R = 1e-4 * Eigen::Matrix3d::Identity();
  measured.yaw_variance = 1e-8;
  EXPECT_TRUE(dead_reckoning.observes(measured));
  dead_reckoning.widenForGap(4.0, measured);
  EXPECT_FALSE(dead_reckoning.observes(measured));
  EXPECT_NEAR(std::sqrt(measured.R(0, 0)), DeadReckoning::Params().acceleration_mps2 * 8.0, 0.01);
}

/// The way over the gap is uncertain by metres, the speed by little more than 1 m/s.
TEST(DeadReckoning, AMeanOverAGapCorrectsTheMotion) {
  DeadReckoning dead_reckoning{DeadReckoning::Params()};
  dead_reckoning.reset(Eigen::Vector3d::Constant(0.1), 0.01);
  MotionDerivatives before;
  before.velocity_body_mps.x() = 5.0;
  before.rpy_rates_rad_s.z() = 0.3;
  DeadReckoning::Measured mean = measured(2.0, 0.01, 0.0, 0.01);
  dead_reckoning.widenForGap(4.0, mean);
  const MotionDerivatives after = dead_reckoning.filter(before, 4.0, &mean);
  EXPECT_LT(after.velocity_body_mps.x(), 3.5);
  EXPECT_LT(after.rpy_rates_rad_s.z(), 0.2);
}

TEST(DeadReckoning, ErrorsOfAGapOfSecondsGoOn) {
  const DeadReckoning dead_reckoning{DeadReckoning::Params()};
  EXPECT_EQ(dead_reckoning.drivenLaterCovariance(3.0, 15.0), Eigen::Matrix4d::Zero());
  const Eigen::Matrix4d gap = dead_reckoning.drivenLaterCovariance(8.0, 15.0);
  EXPECT_GT(std::sqrt(gap(0, 0)), 5.0);
  EXPECT_GT(std::sqrt(gap(1, 1)), 20.0);
  EXPECT_GT(std::sqrt(gap(3, 3)), 0.25);
}

}  // namespace
}  // namespace fail_aware::dead_reckoning_test
