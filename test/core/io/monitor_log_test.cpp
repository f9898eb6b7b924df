#include "core/io/monitor_log.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>

#include "core/io/input_error.hpp"

namespace fail_aware::monitor_log_test {
namespace {

/// Numbers that no short decimal gives back.
MonitorInput oddNumbers() {
  MonitorInput input;
  input.row = 17;
  FilterState& s = input.state;
  s.stamp_s = 1317617735.1 + 1.0 / 3.0;
  s.dt_s = 0.1 / 3.0;
  Vector6d pose;
  pose << 1.0 / 7.0, -200.0 / 3.0, 1e-17, 0.1, 0.2, -3.0;
  s.T_odom_cog = poseFromVector(pose);
  s.T_previous_now = poseFromVector(pose * 0.01);
  s.covariance = Matrix6d::Random();
  s.increment_covariance = Matrix6d::Random() * 1e-9;
  s.sigma_yaw_rad = std::sqrt(2e-7);
  s.measurement_applied = true;
  s.map_update = MapUpdate::kRestart;
  s.filter_nis = 1.0 / 9.0;
  s.fusion.has_measurement = true;
  s.fusion.z = pose / 3.0;
  s.fusion.R = Matrix6d::Random();
  s.fusion.weights = {0.1, 1.0 / 3.0, 0.0};
  s.fusion.nis = {1.7, -1.0, 3e5};
  s.fusion.prediction_overruled = true;
  s.fusion.disagreement_m = 0.1234567890123456789;
  s.fusion.confirmed = true;
  s.fusion.valid_inputs = 2;
  s.fusion.invalid_inputs = 1;
  input.condition.incomplete = true;
  input.condition.dropped_before = 3;
  input.condition.min_information_ratio = 2.0 / 3.0;
  input.condition.ahead = {1.0 / 300.0, 70.0};
  return input;
}

class MonitorLog : public ::testing::Test {
 protected:
  void TearDown() override { std::remove(path_.c_str()); }

  std::string errorOf(const std::string& text) {
    std::ofstream(path_) << text;
    try {
      readMonitorLog(path_);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  std::string path_ = ::testing::TempDir() + "fail_aware_monitor_log_" +
                      ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv";
};

TEST_F(MonitorLog, TextOfWindowsIsRead) {
  EXPECT_EQ(errorOf("\xEF\xBB\xBF" + monitorLogHeader() + "\r\n" + monitorLogRow(oddNumbers()) + "\r\n"), "");
  EXPECT_EQ(readMonitorLog(path_).at(0).row, 17u);
}

TEST_F(MonitorLog, EveryNumberReadsBackAsItself) {
  const MonitorInput input = oddNumbers();
  std::ofstream(path_) << monitorLogHeader() << '\n'
                       << monitorLogRow(input) << '\n'
                       << monitorLogRow(MonitorInput()) << '\n';
  const std::vector<MonitorInput> log = readMonitorLog(path_);
  ASSERT_EQ(log.size(), 2u);
  const MonitorInput& read = log[0];
  EXPECT_EQ(read.row, 17u);
  EXPECT_EQ(read.state.stamp_s, input.state.stamp_s);
  EXPECT_EQ(read.state.dt_s, input.state.dt_s);
  EXPECT_EQ(read.state.T_odom_cog.matrix(), input.state.T_odom_cog.matrix());
  EXPECT_EQ(read.state.T_previous_now.matrix(), input.state.T_previous_now.matrix());
  EXPECT_EQ(read.state.covariance, input.state.covariance);
  EXPECT_EQ(read.state.increment_covariance, input.state.increment_covariance);
  EXPECT_EQ(read.state.sigma_yaw_rad, input.state.sigma_yaw_rad);
  EXPECT_EQ(read.state.fusion.z, input.state.fusion.z);
  EXPECT_EQ(read.state.fusion.R, input.state.fusion.R);
  EXPECT_EQ(read.state.fusion.weights, input.state.fusion.weights);
  EXPECT_EQ(read.state.fusion.nis, input.state.fusion.nis);
  EXPECT_EQ(read.state.map_update, MapUpdate::kRestart);
  EXPECT_TRUE(read.state.measurement_applied && read.state.fusion.prediction_overruled &&
              read.state.fusion.has_measurement);
  EXPECT_FALSE(read.state.fusion.all_gated_out || read.state.fusion.prediction_invalid);
  EXPECT_TRUE(read.state.fusion.confirmed);
  EXPECT_EQ(read.state.fusion.valid_inputs, 2);
  EXPECT_EQ(read.state.fusion.invalid_inputs, 1);
  EXPECT_TRUE(read.condition.incomplete);
  EXPECT_EQ(read.condition.dropped_before, 3);
  EXPECT_EQ(read.condition.min_information_ratio, 2.0 / 3.0);
  EXPECT_EQ(read.condition.ahead.ratio, 1.0 / 300.0);
  EXPECT_EQ(read.condition.ahead.distance_m, 70.0);
  EXPECT_EQ(monitorLogRow(read), monitorLogRow(input)) << "and so every other column";
  EXPECT_TRUE(log[1].state.fusion.weights.empty());
}

TEST_F(MonitorLog, WhatCannotBeReadIsRefusedWithItsLine) {
  const std::string header = monitorLogHeader() + '\n', row = monitorLogRow(oddNumbers());
  EXPECT_EQ(errorOf(header + row + '\n'), "");
  EXPECT_NE(errorOf("stamp,dt\n1,2\n").find(path_ + ":1: "), std::string::npos);
  EXPECT_NE(errorOf(header).find("no sweeps"), std::string::npos);
  EXPECT_NE(errorOf(header + row + "\n1,2,3\n").find(path_ + ":3: "), std::string::npos);
  EXPECT_NE(errorOf(header + row + ",1\n").find("too many columns"), std::string::npos);
  EXPECT_NE(errorOf(header + "seventeen" + row.substr(2)).find("row: 'seventeen' is no number"), std::string::npos);
  EXPECT_NE(errorOf(header + "-1" + row.substr(2)).find("row: '-1' is out of range"), std::string::npos);
  EXPECT_THROW(readMonitorLog("/no/such/log.csv"), InputError);
}

}  // namespace
}  // namespace fail_aware::monitor_log_test
