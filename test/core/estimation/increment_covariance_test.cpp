#include "core/estimation/increment_covariance.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <optional>

#include "../../support/poses.hpp"
#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"

namespace fail_aware::increment_covariance_test {
namespace {

FilterState measured(double sigma_m) {
  FilterState state;
  state.dt_s = 0.1;
  state.measurement_applied = true;
  state.fusion.R = sigma_m * sigma_m * Matrix6d::Identity();
  return state;
}

SweepPrediction known() {
  SweepPrediction prediction;
  prediction.motion_status = MotionStatus::kObserved;
  return prediction;
}

const Matrix6d kMotion = 0.01 * Matrix6d::Identity();

TEST(IncrementCovariance, IsWhatAGoodMeasurementLeaves) {
  FilterState state = measured(0.01);
  setIncrementCovariance(IncrementScale(), kMotion, known(), state);
  EXPECT_NEAR(state.increment_covariance(0, 0), 1e-4, 2e-6);
  EXPECT_TRUE(state.motion_covariance.isApprox(kMotion, 1e-9));
  EXPECT_TRUE(state.registration_covariance.isApprox(1e-4 * Matrix6d::Identity(), 1e-9));
  EXPECT_TRUE(state.registered);
}

TEST(IncrementCovariance, OfAPredictionIsThatOfTheMotion) {
  FilterState state = measured(0.01);
  state.measurement_applied = false;
  setIncrementCovariance(IncrementScale(), kMotion, known(), state);
  EXPECT_NEAR(state.increment_covariance(0, 0), 0.01, 1e-12);
  for (const int i : {0, 1, 2, 5}) EXPECT_NEAR(state.motion_covariance(i, i), kMotion(i, i), 1e-9);
  EXPECT_FALSE(incrementOf(state).registration);
}

TEST(IncrementCovariance, APredictionKeepsTheVehicleOnTheRoad) {
  FilterState state = measured(0.01);
  state.measurement_applied = false;
  Matrix6d any_tilt = kMotion;
  any_tilt(3, 3) = any_tilt(4, 4) = 0.02;
  any_tilt(0, 4) = any_tilt(4, 0) = 0.01;
  setIncrementCovariance(IncrementScale(), any_tilt, known(), state);
  EXPECT_NEAR(std::sqrt(state.motion_covariance(4, 4)), 2.0 * kDegree, 1e-9);
  EXPECT_GT(state.motion_covariance.eigenvalues().real().minCoeff(), 0.0);
  EXPECT_NEAR(state.motion_covariance(0, 0), kMotion(0, 0), 1e-9);
}

TEST(IncrementCovariance, OneMeasurementAfterAClockWasSetBackMayBeWrong) {
  SweepPrediction prediction = known();
  prediction.dt_s = prediction.period_s = 0.1;
  prediction.T_odom_cog.translation().x() = 0.5;
  FilterState state = measured(0.01);
  EXPECT_EQ(clockDoubt(prediction, state).sigma_m, 0.0);
  prediction.set_back_s = 0.3;
  EXPECT_NEAR(clockDoubt(prediction, state).sigma_m, 2.0, 1e-9) << "0.4 s at 5 m/s";
  EXPECT_GT(clockDoubt(prediction, state).sigma_yaw_rad, 0.03);
  state.fusion.confirmed = true;
  EXPECT_EQ(clockDoubt(prediction, state).sigma_m, 0.0);
}

TEST(IncrementCovariance, AClockJumpIsAmbiguousWhereTheMapHoldsOneOfThePlaces) {
  FilterState state = measured(0.01);
  SweepPrediction prediction = known();
  for (const double apart_m : {20.0, 170.0}) {
    prediction.T_odom_cog.translation().x() = apart_m;
    EXPECT_EQ(clockDoubt(prediction, state).sigma_m, 0.0) << "no jump";
    state.clock_jump = true;
    EXPECT_EQ(clockDoubt(prediction, state).sigma_m, apart_m > 100.0 ? apart_m : 0.0);
    state.clock_jump = false;
  }
}

TEST(IncrementCovariance, AfterAClockJumpTheMotionIsNotKnown) {
  FilterState state = measured(0.01);
  state.clock_jump = true;
  setIncrementCovariance(IncrementScale(), kMotion, known(), state);
  EXPECT_GT(state.motion_covariance(0, 0), 100.0);
  EXPECT_NEAR(state.increment_covariance(0, 0), 1e-4, 1e-9);
}

TEST(IncrementCovariance, NothingIsRegisteredBeforeAMotionIsKnown) {
  FilterState state = measured(0.01);
  setIncrementCovariance(IncrementScale(), kMotion, SweepPrediction(), state);
  EXPECT_FALSE(state.registered);
  EXPECT_NEAR(state.increment_covariance(0, 0), 1e-4, 2e-6);
}

TEST(IncrementCovariance, FloorAndScaleAreKept) {
  FilterState state = measured(1e-6);
  state.T_previous_now.translation().x() = 2.0;
  setIncrementCovariance({0.5, 1.0, 0.01, 0.005, 0.1}, kMotion, known(), state);
  EXPECT_NEAR(state.increment_covariance(0, 0), 0.02 * 0.02, 1e-9);
  EXPECT_NEAR(state.increment_covariance(5, 5), 0.01 * kDegree * kDegree, 1e-9);
  state.measurement_applied = false;
  setIncrementCovariance({0.5, 3.0, 0.0, 0.0, 0.0}, kMotion, known(), state);
  EXPECT_NEAR(state.increment_covariance(0, 0), 0.015, 1e-12);
  EXPECT_NEAR(state.motion_covariance(0, 0), 0.03, 1e-12) << "predictions that follow each other err alike";
}

const Matrix6d kIncrement = [] {
  Matrix6d C = (Vector6d() << 4e-4, 1e-4, 2e-4, 1e-6, 1e-6, 4e-6).finished().asDiagonal();
  C(1, 5) = C(5, 1) = 1e-5;
  return C;
}();

TEST(IncrementTwist, RecoversAConstantTwistAndRefusesBadIntervals) {
  Vector6d twist;
  twist << 20.0, 0.3, -0.1, 0.02, -0.01, 0.5;
  const std::optional<Vector6d> got = twistFromIncrement(expSe3(0.1 * twist), 0.1);
  ASSERT_TRUE(got);
  EXPECT_TRUE(got->isApprox(twist, 1e-9));
  using Limits = std::numeric_limits<double>;
  for (const double dt : {0.0, -0.1, Limits::quiet_NaN(), Limits::infinity()}) {
    EXPECT_FALSE(twistFromIncrement(Pose::Identity(), dt));
    EXPECT_FALSE(twistCovariance(kIncrement, Pose::Identity(), dt));
  }
  EXPECT_FALSE(twistCovariance(Matrix6d::Constant(std::numeric_limits<double>::quiet_NaN()), Pose::Identity(), 0.1));
}

TEST(IncrementTwist, CovarianceAgainstFiniteDifferences) {
  Vector6d twist;
  twist << 30.0, 0.3, -0.1, 0.1, -0.2, 0.8;
  const double dt = 0.1;
  const Pose increment = expSe3(dt * twist);
  Matrix6d J;
  const double h = 1e-6;
  for (int i = 0; i < 6; ++i) {
    const Vector6d e = h * Vector6d::Unit(i);
    J.col(i) = (*twistFromIncrement(perturbed(increment, e), dt) - *twistFromIncrement(perturbed(increment, -e), dt)) /
               (2.0 * h);
  }
  const Matrix6d expected = J * kIncrement * J.transpose();
  const std::optional<Matrix6d> got = twistCovariance(kIncrement, increment, dt);
  ASSERT_TRUE(got);
  const Vector6d scale = expected.diagonal().cwiseSqrt().cwiseInverse();
  EXPECT_LT((scale.asDiagonal() * (*got - expected) * scale.asDiagonal()).cwiseAbs().maxCoeff(), 1e-5);
}

}  // namespace
}  // namespace fail_aware::increment_covariance_test
