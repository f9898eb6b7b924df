#include "core/integrity/monitor_replay.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fail_aware::monitor_replay_test {
namespace {

/// Wavering uncertainty, on a bend, with sweeps that have no measurement.
std::vector<MonitorInput> drive(int sweeps) {
  std::vector<MonitorInput> log;
  Pose T = Pose::Identity();
  for (int i = 0; i < sweeps; ++i) {
    MonitorInput input;
    FilterState& s = input.state;
    input.row = static_cast<std::size_t>(i);
    s.stamp_s = 100.0 + 0.1 * i;
    s.dt_s = i == 0 ? 0.0 : 0.1;
    Vector6d step;
    step << 1.0, 0.0, 0.0, 0.0, 0.0, 0.01;
    s.T_previous_now = i == 0 ? Pose::Identity() : poseFromVector(step);
    T = T * s.T_previous_now;
    s.T_odom_cog = T;
    s.measurement_applied = i % 7 != 3;
    s.motion_status = MotionStatus::kObserved;
    s.fusion.valid_inputs = s.measurement_applied ? 3 : 0;
    s.fusion.confirmed = s.measurement_applied;
    s.sigma_yaw_rad = 1e-3 * (1.0 + 0.2 * std::sin(0.9 * i));
    s.map_update = MapUpdate::kInsert;
    s.motion_covariance.diagonal() << 1e-4, 1e-4, 1e-4, 1e-8, 1e-8, 1e-7;
    input.condition.corners_missing = i % 2 == 0;
    log.push_back(input);
  }
  return log;
}

/// As the pipeline and the nodelet do it.
std::vector<MonitorOutput> live(const std::vector<MonitorInput>& log, std::size_t start_row) {
  FailAwareMonitor monitor{MonitorParameters()};
  std::vector<MonitorOutput> outputs;
  for (std::size_t i = 0; i < log.size(); ++i) {
    if (i == start_row) monitor.start();
    outputs.push_back(monitor.update(log[i].state, log[i].condition));
  }
  return outputs;
}

TEST(MonitorReplay, EqualsTheLiveMonitorForAnyStart) {
  const std::vector<MonitorInput> log = drive(120);
  for (const auto& [start_s, row] : {std::pair<double, std::size_t>{0.0, 0}, {3.0, 30}, {3.05, 31}, {50.0, 999}}) {
    const std::vector<MonitorOutput> expected = live(log, row), replayed = replayMonitor(log, start_s, {});
    ASSERT_EQ(replayed.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(replayed[i].state, expected[i].state) << start_s << ", sweep " << i;
      EXPECT_EQ(replayed[i].reasons, expected[i].reasons);
      EXPECT_EQ(replayed[i].eta, expected[i].eta);
      EXPECT_EQ(replayed[i].time_to_failure.seconds, expected[i].time_to_failure.seconds);
      EXPECT_EQ(replayed[i].time_to_failure_covariance.seconds, expected[i].time_to_failure_covariance.seconds);
      EXPECT_EQ(replayed[i].sigma_x_m, expected[i].sigma_x_m);
      EXPECT_EQ(replayed[i].sigma_y_m, expected[i].sigma_y_m);
      EXPECT_EQ(replayed[i].time_to_failure.isKnown(), i >= row && i > 0) << "nothing is known of the first sweep";
    }
  }
}

TEST(MonitorReplay, AFirstSweepInTheMiddleIsAReset) {
  std::vector<MonitorInput> log = drive(40);
  const std::vector<MonitorInput> again = drive(20);
  log.insert(log.end(), again.begin(), again.end());
  for (std::size_t i = 40; i < log.size(); ++i) log[i].state.stamp_s += 4.0;
  const std::vector<MonitorOutput> outputs = replayMonitor(log, 0.0, {});
  EXPECT_GT(outputs[39].sigma_y_m, 0.0);
  EXPECT_EQ(outputs[40].sigma_y_m, 0.0) << "it goes on serving, from a new t1";
  EXPECT_NEAR(outputs[59].sigma_y_m, outputs[19].sigma_y_m, 1e-12);
}

TEST(MonitorReplay, OfNoSweepsIsEmpty) { EXPECT_TRUE(replayMonitor({}, 0.0, {}).empty()); }

}  // namespace
}  // namespace fail_aware::monitor_replay_test
