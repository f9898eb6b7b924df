#include "core/io/measurement_log.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>

#include "core/io/input_error.hpp"

namespace fail_aware::measurement_log_test {
namespace {

Pose pose(double x, double y, double yaw) {
  Vector6d v;
  v << x, y, 0.0, 0.0, 0.0, yaw;
  return poseFromVector(v);
}

class MeasurementLog : public ::testing::Test {
 protected:
  void TearDown() override { std::remove(path_.c_str()); }

  std::string path_ = ::testing::TempDir() + "fail_aware_measurement_log_" +
                      ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv";
};

TEST_F(MeasurementLog, AMotionIsThatFromTheLastEstimateAboutItsAxes) {
  const Pose T_odom_previous = pose(10.0, 20.0, M_PI / 2.0);
  FilterState state;
  state.T_previous_now = pose(1.0, 0.1, 0.02);
  state.T_odom_cog = T_odom_previous * state.T_previous_now;
  Measurement measurement;
  measurement.T_odom_cog = T_odom_previous * pose(1.1, 0.0, 0.01);
  measurement.covariance.diagonal() << 1.0, 4.0, 9.0, 0.1, 0.2, 0.3;
  const MeasuredMotion motion = measuredMotion(7, 2, measurement, state);
  EXPECT_EQ(motion.row, 7u);
  EXPECT_EQ(motion.source, 2u);
  EXPECT_TRUE(motion.T_previous_now.isApprox(pose(1.1, 0.0, 0.01), 1e-12));
  Vector6d expected;
  expected << 4.0, 1.0, 9.0, 0.2, 0.1, 0.3;  // odom's y is the vehicle's x
  EXPECT_TRUE(motion.covariance.isApprox(Matrix6d(expected.asDiagonal()), 1e-12)) << motion.covariance;
}

TEST_F(MeasurementLog, EveryNumberReadsBackAsItself) {
  MeasuredMotion motion{17, 1, pose(1.0 / 3.0, 1e-17, -0.1), Matrix6d::Random()};
  std::ofstream(path_) << measurementLogHeader() << '\n' << measurementLogRow(motion) << '\n';
  const std::vector<MeasuredMotion> log = readMeasurementLog(path_);
  ASSERT_EQ(log.size(), 1u);
  EXPECT_EQ(log[0].row, 17u);
  EXPECT_EQ(log[0].source, 1u);
  EXPECT_EQ(log[0].T_previous_now.matrix(), motion.T_previous_now.matrix());
  EXPECT_EQ(log[0].covariance, motion.covariance);
}

TEST_F(MeasurementLog, WhatCannotBeReadIsRefusedWithItsLine) {
  std::ofstream(path_) << measurementLogHeader() << "\n1,2,3\n";
  try {
    readMeasurementLog(path_);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(path_ + ":2: "), std::string::npos) << error.what();
  }
  std::ofstream(path_) << "row\n1\n";
  EXPECT_THROW(readMeasurementLog(path_), InputError);
  EXPECT_THROW(readMeasurementLog("/no/such/measurements.csv"), InputError);
}

}  // namespace
}  // namespace fail_aware::measurement_log_test
