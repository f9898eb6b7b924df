#include "core/estimation/vehicle/motion_derivatives.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "../../../support/poses.hpp"
#include "core/geometry/rotation.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::motion_derivatives_test {
namespace {

// Speed s(t) = 8 + 1.5 t along the heading yaw(t) = 0.3 t + 0.1 t^2, integrated finely.
Pose curvedDrive(double t) {
  double x = 0.0, y = 0.0;
  const int steps = 2000;
  for (int i = 0; i < steps; ++i) {
    const double at = t * (i + 0.5) / steps;
    const double speed = 8.0 + 1.5 * at, yaw = 0.3 * at + 0.1 * at * at;
    x += speed * std::cos(yaw) * t / steps;
    y += speed * std::sin(yaw) * t / steps;
  }
  return pose(x, y, 0.0, 0.0, 0.0, wrapAngle(0.3 * t + 0.1 * t * t));
}

TEST(MotionHistory, NeedsTwoPoses) {
  MotionHistory history{MotionHistory::Params()};
  EXPECT_FALSE(history.derivatives().valid);
  history.push(0.0, Pose::Identity());
  EXPECT_FALSE(history.derivatives().valid);
  history.push(0.1, pose(1.0, 0.0, 0.0, 0.0, 0.0, 0.02));
  const MotionDerivatives motion = history.derivatives();
  ASSERT_TRUE(motion.valid);
  EXPECT_NEAR(motion.velocity_body_mps.x(), 10.0, 0.01);
  EXPECT_NEAR(motion.rpy_rates_rad_s.z(), 0.2, 1e-12);
  EXPECT_EQ(motion.acceleration_body_mps2.norm(), 0.0);
}

TEST(MotionHistory, ConstantTwistIsExactAtIrregularStamps) {
  Vector6d twist;
  twist << 12.0, -0.4, 0.1, 0.0, 0.0, 0.7;
  MotionHistory history{MotionHistory::Params()};
  for (const double t : {100.0, 100.1, 100.13, 100.31, 100.4, 100.55}) history.push(t, expSe3(twist * (t - 100.0)));
  const MotionDerivatives motion = history.derivatives();
  EXPECT_LT((motion.velocity_body_mps - twist.head<3>()).norm(), 1e-9);
  EXPECT_LT(motion.acceleration_body_mps2.norm(), 1e-7);
  EXPECT_NEAR(motion.rpy_rates_rad_s.z(), 0.7, 1e-9);
}

TEST(MotionHistory, AcceleratedCurveIsGivenAtTheNewestStamp) {
  MotionHistory history{MotionHistory::Params()};
  const double newest = 2.0;
  for (const double t : {1.5, 1.6, 1.68, 1.8, 1.93, newest}) history.push(t, curvedDrive(t));
  const MotionDerivatives motion = history.derivatives();
  // half an interval of lag would be 0.05 s: 0.075 m/s and 0.01 rad/s
  EXPECT_NEAR(motion.velocity_body_mps.x(), 8.0 + 1.5 * newest, 0.01);
  EXPECT_NEAR(motion.velocity_body_mps.y(), 0.0, 0.02);
  EXPECT_NEAR(motion.acceleration_body_mps2.x(), 1.5, 0.05);
  EXPECT_NEAR(motion.rpy_rates_rad_s.z(), 0.3 + 0.2 * newest, 1e-6);
  EXPECT_NEAR(motion.rpy_accelerations_rad_s2.z(), 0.2, 1e-6);
}

TEST(MotionHistory, ReverseIsNegativeAndYawMayCrossPi) {
  MotionHistory history{MotionHistory::Params()};
  for (int i = 0; i < 6; ++i) {
    const double yaw = wrapAngle(M_PI - 0.05 + 0.02 * i);
    history.push(0.1 * i, pose(-0.2 * i * std::cos(M_PI), 0.0, 0.0, 0.0, 0.0, yaw));
  }
  const MotionDerivatives motion = history.derivatives();
  EXPECT_NEAR(motion.velocity_body_mps.x(), -2.0, 0.05);
  EXPECT_NEAR(motion.rpy_rates_rad_s.z(), 0.2, 1e-9);
}

TEST(MotionHistory, RollAndPitchRatesAreThoseOfTheNewestInterval) {
  MotionHistory history{MotionHistory::Params()};
  for (int i = 0; i < 5; ++i) history.push(0.1 * i, pose(0.0, 0.0, 0.0, 0.01 * i * i, -0.02 * i, 0.0));
  const MotionDerivatives motion = history.derivatives();
  EXPECT_NEAR(motion.rpy_rates_rad_s.x(), 0.7, 1e-9);
  EXPECT_NEAR(motion.rpy_rates_rad_s.y(), -0.2, 1e-9);
  EXPECT_NEAR(motion.rpy_accelerations_rad_s2.x(), 2.0, 1e-9);
}

TEST(MotionHistory, SecondDifferencesAreTheArticlesOnes) {
  MotionHistory::Params params;
  params.second_differences = true;
  MotionHistory history(params);
  history.push(0.0, pose(0.0, 0.0, 0.0, 0.0, 0.0, 0.0));
  history.push(0.1, pose(1.0, 0.0, 0.0, 0.0, 0.0, 0.01));
  history.push(0.3, pose(3.2, 0.0, 0.0, 0.0, 0.0, 0.05));
  const MotionDerivatives motion = history.derivatives();
  const double v_before = 10.0 * std::cos(0.01), v_after = 11.0 * std::cos(0.05);
  EXPECT_NEAR(motion.velocity_body_mps.x(), v_after, 1e-9);
  EXPECT_NEAR(motion.acceleration_body_mps2.x(), (v_after - v_before) / 0.2, 1e-9);
  EXPECT_NEAR(motion.rpy_rates_rad_s.z(), 0.2, 1e-9);
  EXPECT_NEAR(motion.rpy_accelerations_rad_s2.z(), 0.5, 1e-9);
}

TEST(MotionHistory, WindowIsQuieterThanSecondDifferences) {
  MotionHistory::Params literal;
  literal.second_differences = true;
  MotionHistory window{MotionHistory::Params()}, differences(literal);
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 0.01);
  double window_v = 0.0, differences_v = 0.0, window_a = 0.0, differences_a = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const Pose noisy = pose(1.0 * i + noise(random), noise(random), noise(random), 0.0, 0.0, 0.1 * noise(random));
    window.push(0.1 * i, noisy);
    differences.push(0.1 * i, noisy);
    if (i < 10) continue;
    const MotionDerivatives a = window.derivatives(), b = differences.derivatives();
    window_v += std::pow(a.velocity_body_mps.x() - 10.0, 2);
    differences_v += std::pow(b.velocity_body_mps.x() + 0.05 * b.acceleration_body_mps2.x() - 10.0, 2);
    window_a += a.acceleration_body_mps2.squaredNorm();
    differences_a += b.acceleration_body_mps2.squaredNorm();
  }
  EXPECT_LT(window_v, 0.7 * differences_v);
  EXPECT_LT(window_a, 0.15 * differences_a);
}

TEST(MotionHistory, AbsurdAccelerationsAreCut) {
  MotionHistory history{MotionHistory::Params()};
  history.push(0.0, Pose::Identity());
  history.push(0.1, Pose::Identity());
  history.push(0.2, pose(30.0, 0.0, 0.0, 0.0, 0.0, 3.0));
  const MotionDerivatives motion = history.derivatives();
  EXPECT_NEAR(motion.acceleration_body_mps2.norm(), 12.0, 1e-9);
  EXPECT_NEAR(motion.rpy_accelerations_rad_s2.z(), 10.0, 1e-9);
}

TEST(MotionHistory, APoseTooCloseReplacesItsPredecessor) {
  MotionHistory history{MotionHistory::Params()};
  for (int i = 0; i < 8; ++i) history.push(0.1 * i, pose(1.0 * i, 0.0, 0.0, 0.0, 0.0, 0.0));
  history.push(0.701, pose(7.02, 0.0, 0.0, 0.0, 0.0, 0.0));
  EXPECT_NEAR(history.derivatives().velocity_body_mps.x(), 10.0, 0.2);
}

TEST(MotionHistory, AfterAGapOldIntervalsCountNoMore) {
  MotionHistory history{MotionHistory::Params()};
  for (int i = 0; i < 8; ++i) history.push(0.1 * i, pose(1.0 * i, 0.0, 0.0, 0.0, 0.0, 0.0));
  history.push(10.7, pose(27.0, 0.0, 0.0, 0.0, 0.0, 0.0));
  const MotionDerivatives motion = history.derivatives();
  EXPECT_NEAR(motion.velocity_body_mps.x(), 2.0, 1e-9);
  EXPECT_EQ(motion.acceleration_body_mps2.norm(), 0.0);
}

TEST(MotionHistory, RefusesWhatItCannotUse) {
  MotionHistory history{MotionHistory::Params()};
  const Pose other = pose(5.0, 0.0, 0.0, 0.0, 0.0, 0.0);
  history.push(1.0, Pose::Identity());
  history.push(1.0, other);
  history.push(0.5, other);
  history.push(std::numeric_limits<double>::quiet_NaN(), other);
  Pose broken = Pose::Identity();
  broken.translation().x() = std::numeric_limits<double>::infinity();
  history.push(1.1, broken);
  EXPECT_FALSE(history.derivatives().valid) << "of one pose alone";
  history.push(1.1, pose(1.0, 0.0, 0.0, 0.0, 0.0, 0.0));
  EXPECT_NEAR(history.derivatives().velocity_body_mps.x(), 10.0, 1e-9) << "from the pose at 1 s";
  history.clear();
  EXPECT_FALSE(history.derivatives().valid);
  history.push(0.5, Pose::Identity());
  history.push(0.6, pose(2.0, 0.0, 0.0, 0.0, 0.0, 0.0));
  EXPECT_NEAR(history.derivatives().velocity_body_mps.x(), 20.0, 1e-9);
}

TEST(MotionHistory, ValidatesItsParameters) {
  MotionHistory::Params params;
  params.window_sweeps = 0;
  EXPECT_THROW(validate(params), ParameterError);
  params = MotionHistory::Params();
  params.acceleration_window_sweeps = 1;
  EXPECT_THROW(validate(params), ParameterError);
}

TEST(MotionHistory, InAnotherOdomTheMotionIsTheSame) {
  MotionHistory history{MotionHistory::Params()};
  Vector6d twist;
  twist << 12.0, 0.1, 0.0, 0.0, 0.0, 0.3;
  for (int i = 0; i < 6; ++i) history.push(5.0 + 0.1 * i, expSe3(0.1 * i * (1.0 + 0.02 * i) * twist));
  const MotionDerivatives before = history.derivatives();
  history.move(poseFromVector((Vector6d() << 50.0, -3.0, 1.0, 0.0, 0.0, 3.0).finished()));
  const MotionDerivatives after = history.derivatives();
  EXPECT_TRUE(after.valid);
  EXPECT_LT((after.velocity_body_mps - before.velocity_body_mps).norm(), 1e-9);
  EXPECT_LT((after.acceleration_body_mps2 - before.acceleration_body_mps2).norm(), 1e-7);
  EXPECT_LT((after.rpy_rates_rad_s - before.rpy_rates_rad_s).norm(), 1e-9);
}

}  // namespace
}  // namespace fail_aware::motion_derivatives_test
