#include "evaluation/fail_aware_episode.hpp"

#include <gtest/gtest.h>

#include "core/geometry/rotation.hpp"
#include "core/integrity/monitor_replay.hpp"
#include "made_up_episode.hpp"

namespace fail_aware::fail_aware_episode_test {
namespace {

/// 1 m a sweep along y of the truth's frame; the estimate drifts to its left by `drift_m` a sweep.
struct Drive {
  explicit Drive(int sweeps, double drift_m) {
    for (int i = 0; i < sweeps; ++i) {
      Pose T_true = Pose::Identity();
      T_true.linear() = rotationFromRpy(0.0, 0.0, M_PI / 2.0);
      T_true.translation() << 0.0, i, 0.0;
      truth.push_back(T_true);
      MonitorInput input;
      input.row = static_cast<std::size_t>(i);
      input.state.stamp_s = 7.0 + 0.1 * i;
      input.state.dt_s = i == 0 ? 0.0 : 0.1;
      input.state.T_odom_cog.translation() << i, drift_m * i, 0.0;
      if (i > 0) input.state.T_previous_now.translation() << 1.0, drift_m, 0.0;
      input.state.measurement_applied = true;
      input.state.map_update = MapUpdate::kInsert;
      input.state.motion_status = MotionStatus::kObserved;
      input.state.fusion.valid_inputs = 3;
      input.state.fusion.confirmed = true;
      input.state.increment_covariance = input.state.motion_covariance = 1e-4 * Matrix6d::Identity();
      log.push_back(input);
    }
  }
  std::vector<Pose> truth;
  std::vector<MonitorInput> log;
};

TEST(FailAwareEpisode, HoldsTheErrorAndWhatTheMonitorSaid) {
  const Drive drive(120, 0.011);  // 0.605 m after 55 sweeps
  const std::vector<FailAwareEpisode> episodes = failAwareEpisodes(drive.truth, drive.log, MonitorParameters());
  ASSERT_EQ(episodes.size(), 3u);  // t1 at 0, 5, 10 s of 11.9
  EXPECT_TRUE(episodes[0].failed && episodes[1].failed && !episodes[2].failed);
  EXPECT_NEAR(episodes[1].time_s, 5.5, 1e-6);
  EXPECT_NEAR(episodes[1].begin_s, 12.0, 1e-6);
  EXPECT_NEAR(episodes[2].time_s, 1.9, 1e-6);
  ASSERT_EQ(episodes[1].sweeps.size(), 70u);
  EXPECT_EQ(episodes[1].sweepsBeforeFailure(), 55u);
  EXPECT_EQ(episodes[2].sweepsBeforeFailure(), 20u);
  const FailAwareSweep& sweep = episodes[1].sweeps[20];
  EXPECT_NEAR(sweep.since_start_s, 2.0, 1e-6);
  EXPECT_NEAR(sweep.remaining_s, 3.5, 1e-6);
  EXPECT_NEAR(sweep.distance_m, 20.0, 0.01);
  EXPECT_NEAR(sweep.speed_mps, 10.0, 0.01);
  EXPECT_NEAR(sweep.error_m.x(), 0.0, 1e-9);
  EXPECT_NEAR(sweep.error_m.y(), -0.22, 1e-9) << "truth - estimate, in the frame at t1";

  const std::vector<MonitorOutput> replayed = replayMonitor(drive.log, 5.0, MonitorParameters());
  EXPECT_EQ(sweep.output.time_to_failure.seconds, replayed[70].time_to_failure.seconds);
  EXPECT_GT(sweep.output.covariance_since_start(1, 1), 0.0);
  EXPECT_GT(sweep.output.protection_level_m, sweep.output.sigma_y_m);
}

TEST(FailAwareEpisode, BeginsWhereTheMotionIsObserved) {
  Drive drive(120, 0.0);
  for (std::size_t i = 0; i < 3; ++i) drive.log[i].state.motion_status = MotionStatus::kDeadReckoning;
  for (std::size_t i = 48; i < 102; ++i) drive.log[i].state.motion_status = MotionStatus::kDeadReckoning;
  const std::vector<FailAwareEpisode> episodes = failAwareEpisodes(drive.truth, drive.log, MonitorParameters());
  ASSERT_EQ(episodes.size(), 2u) << "asked for at 0, 5, 10 s; the last two wait for the same sweep";
  EXPECT_NEAR(episodes[0].begin_s, 7.3, 1e-6);
  EXPECT_NEAR(episodes[1].begin_s, 17.2, 1e-6);
  for (const FailAwareEpisode& episode : episodes) {
    EXPECT_EQ(episode.sweeps.front().output.t1_stamp_s, episode.begin_s);
  }
}

TEST(FailAwareEpisode, KnowsHowLongTheMonitorHeardNothing) {
  Drive drive(60, 0.0);
  for (std::size_t i = 40; i < drive.log.size(); ++i) drive.log[i].state.stamp_s += 1.0;
  drive.log[40].state.dt_s = 1.1;
  const FailAwareEpisode episode = failAwareEpisodes(drive.truth, drive.log, MonitorParameters()).front();
  EXPECT_NEAR(episode.sweeps[39].silent_s, 0.8, 1e-6) << "stale after three periods";
  EXPECT_EQ(episode.sweeps[38].silent_s, 0.0);
  EXPECT_EQ(episode.sweeps[40].silent_s, 0.0);
  EXPECT_EQ(episode.sweeps.back().silent_s, 0.0);
}

TEST(FailAwareEpisode, JudgedEverySecondBeforeFailure) {
  EXPECT_EQ(judgedSweeps(madeUpEpisode(std::string(85, 'o'), -1)), (std::vector<std::size_t>{10, 30, 50, 60, 70, 80}));
  EXPECT_EQ(judgedSweeps(madeUpEpisode(std::string(85, 'o'), 60)), (std::vector<std::size_t>{10, 30, 50}));
  EXPECT_TRUE(judgedSweeps(madeUpEpisode("oooo", -1)).empty());
  FailAwareEpisode gap = madeUpEpisode(std::string(85, 'o'), -1);
  gap.sweeps.erase(gap.sweeps.begin() + 25, gap.sweeps.begin() + 65);  // 2.5 .. 6.4 s
  EXPECT_EQ(judgedSweeps(gap), (std::vector<std::size_t>{10, 25, 30, 40}));
}

}  // namespace
}  // namespace fail_aware::fail_aware_episode_test
