#include "core/registration/measurement_update.hpp"

#include <gtest/gtest.h>

namespace fail_aware::measurement_update_test {
namespace {

TEST(MeasurementUpdate, TwoEquallySureMeetHalfWay) {
  Measurement measurement;
  measurement.status = MeasurementStatus::kOk;
  measurement.covariance = 0.04 * Matrix6d::Identity();
  addPosition(Eigen::Vector3d::UnitY(), 1.0, 0.2, measurement);
  EXPECT_NEAR(measurement.T_odom_cog.translation().y(), 0.5, 1e-12);
  EXPECT_EQ(measurement.T_odom_cog.translation().x(), 0.0);
  EXPECT_NEAR(measurement.covariance(1, 1), 0.02, 1e-12);
  EXPECT_EQ(measurement.covariance(0, 0), 0.04);
}

// The Kalman filter with one scalar measurement.
TEST(MeasurementUpdate, WhatIsCorrelatedMovesAlong) {
  Measurement measurement;
  measurement.covariance = Matrix6d::Identity();
  measurement.covariance(0, 5) = measurement.covariance(5, 0) = 0.5;
  const Vector6d along = Vector6d::Unit(0);
  addOffset(along, 1.0, 1.0, measurement);
  EXPECT_NEAR(measurement.covariance(5, 5), 1.0 - 0.5 * 0.5 / 2.0, 1e-12);
  EXPECT_NEAR(measurement.covariance(0, 5), 0.5 - 0.5 * 0.5, 1e-12);
  EXPECT_GT(measurement.T_odom_cog.linear()(1, 0), 0.2) << "it turned to the left";
}

TEST(MeasurementUpdate, TheCovarianceStaysSymmetric) {
  Measurement measurement;
  measurement.covariance = Matrix6d::Identity();
  Vector6d along;
  along << 0.3, -0.2, 0.1, 0.7, 0.5, 0.9;
  addOffset(along, 0.1, 0.01, measurement);
  EXPECT_EQ(measurement.covariance, measurement.covariance.transpose().eval());
}

}  // namespace
}  // namespace fail_aware::measurement_update_test
