#include "../../src/nodelets/drive_monitor.hpp"

#include <gtest/gtest.h>

namespace fail_aware::drive_monitor_test {
namespace {

/// Whether it serves once a sweep of that interval has come; 0: the first of a drive.
bool servesAfter(DriveMonitor& monitor, double dt_s) {
  FilterState state;
  state.dt_s = dt_s;
  monitor.update(state, SweepCondition());
  return monitor.monitor().started();
}

TEST(DriveMonitor, WhereItAlwaysServesEveryDriveIsServed) {
  DriveMonitor monitor(MonitorParameters(), true);
  EXPECT_TRUE(servesAfter(monitor, 0.0));
  EXPECT_TRUE(servesAfter(monitor, 0.1));
  EXPECT_TRUE(servesAfter(monitor, 0.0));
}

TEST(DriveMonitor, OtherwiseItServesWhoAsks) {
  DriveMonitor monitor(MonitorParameters(), false);
  EXPECT_FALSE(servesAfter(monitor, 0.0));
  EXPECT_FALSE(servesAfter(monitor, 0.1));
  monitor.serve();
  EXPECT_TRUE(monitor.monitor().startPending());
}

TEST(DriveMonitor, ARequestSinceTheLastStateIsForTheNewDrive) {
  DriveMonitor monitor(MonitorParameters(), false);
  servesAfter(monitor, 0.0);
  monitor.serve();
  EXPECT_TRUE(servesAfter(monitor, 0.0));
}

TEST(DriveMonitor, AWaitingRequestEndsWhereOdomIsMoved) {
  enum class Odom { kGoesOn, kIsSet, kIsReset };
  for (const Odom odom : {Odom::kGoesOn, Odom::kIsSet, Odom::kIsReset}) {
    DriveMonitor monitor(MonitorParameters(), false);
    servesAfter(monitor, 0.0);
    monitor.serve();
    FilterState state;
    state.dt_s = 0.1;
    state.motion_status = MotionStatus::kUnknown;
    state.T_odom_cog.translation().x() = state.T_previous_now.translation().x() = 1.0;
    monitor.update(state, SweepCondition());
    state.dt_s = 0.0;
    if (odom != Odom::kGoesOn) state.T_odom_cog = Pose::Identity();
    if (odom == Odom::kIsSet) ++state.odom_reset_count;
    monitor.update(state, SweepCondition());
    EXPECT_EQ(monitor.monitor().startPending(), odom != Odom::kIsReset) << static_cast<int>(odom);
  }
}

TEST(DriveMonitor, AFilterStartedAnewEndsAWaitingRequest) {
  DriveMonitor monitor(MonitorParameters(), false);
  FilterState state;
  state.odom_reset_count = 2;  // poses were set
  monitor.update(state, SweepCondition());
  monitor.serve();
  state.dt_s = 0.1;
  state.motion_status = MotionStatus::kUnknown;
  state.T_odom_cog.translation().x() = state.T_previous_now.translation().x() = 1.0;
  monitor.update(state, SweepCondition());
  ASSERT_TRUE(monitor.monitor().startPending());
  monitor.update(FilterState(), SweepCondition());
  EXPECT_FALSE(monitor.monitor().startPending());
}

TEST(DriveMonitor, ItStopsServingUnlessItAlwaysServes) {
  DriveMonitor always(MonitorParameters(), true), asked(MonitorParameters(), false);
  EXPECT_FALSE(always.stopServing());
  EXPECT_TRUE(always.monitor().started());
  asked.serve();
  EXPECT_TRUE(asked.stopServing());
  EXPECT_FALSE(servesAfter(asked, 0.1));
  EXPECT_FALSE(servesAfter(asked, 0.0)) << "nor in the next drive";
}

TEST(DriveMonitor, LimitsOutlastTheDrive) {
  DriveMonitor monitor(MonitorParameters(), true);
  MonitorParameters changed;
  changed.predictor.alert_limit_m = 0.9;
  monitor.setLimits(changed);
  servesAfter(monitor, 0.0);
  EXPECT_EQ(monitor.params().predictor.alert_limit_m, 0.9);
}

}  // namespace
}  // namespace fail_aware::drive_monitor_test
