#include "core/estimation/drift_state.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "core/geometry/rotation.hpp"

namespace fail_aware::drift_state_test {
namespace {

/// 1 m ahead, of which a registration leaves everything and the map takes half.
DriftStep stepAhead(double motion_variance) {
  DriftStep step;
  step.step_m.x() = 1.0;
  step.dt_s = 0.1;
  step.motion = motion_variance * Matrix6d::Identity();
  step.replaced = 0.5;
  return step;
}

TEST(DriftState, WhatTheMapTakesOverStaysInThePose) {
  DriftState state;
  state.C.block<6, 6>(DriftState::kInMap, DriftState::kInMap) = Matrix6d::Identity();
  const Matrix6d before = state.pose();
  state.foldIntoMap(0.3);
  EXPECT_TRUE(state.pose().isApprox(before, 1e-12));
  EXPECT_NEAR(state.inMap()(0, 0), 0.49, 1e-12);
}

TEST(DriftSinceMark, IsZeroAtTheMarkAndGrowsAboutItsAxes) {
  const Eigen::Matrix3d R_odom_mark = expSo3(Eigen::Vector3d(0.0, 0.0, M_PI / 2.0));
  DriftStep step = stepAhead(0.0);
  step.R_odom_previous = R_odom_mark;
  step.motion(0, 0) = 0.04;  // along the vehicle, and so along the mark's x
  DriftSinceMark drift(R_odom_mark, DriftState());
  EXPECT_TRUE(drift.covariance().isZero());
  ASSERT_TRUE(drift.add(step));
  EXPECT_NEAR(drift.covariance()(0, 0), 0.04, 1e-12);
  EXPECT_NEAR(drift.covariance()(1, 1), 0.0, 1e-12);
}

TEST(DriftSinceMark, AnOverflowChangesNothing) {
  DriftSinceMark drift(Eigen::Matrix3d::Identity(), DriftState());
  ASSERT_TRUE(drift.add(stepAhead(0.01)));
  const Matrix6d before = drift.covariance();
  EXPECT_FALSE(drift.add(stepAhead(std::numeric_limits<double>::infinity())));
  EXPECT_EQ(drift.covariance(), before);
  EXPECT_TRUE(drift.state().C.allFinite());
}

}  // namespace
}  // namespace fail_aware::drift_state_test
