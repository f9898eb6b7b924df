#include "evaluation/alarm_statistics.hpp"

#include <gtest/gtest.h>

#include "made_up_episode.hpp"

namespace fail_aware::alarm_statistics_test {
namespace {

TEST(AlarmStatistics, AlarmsAreFailingAndFailed) {
  EXPECT_TRUE(isAlarm(FailAwareState::kFailing));
  EXPECT_TRUE(isAlarm(FailAwareState::kFailed));
  for (const FailAwareState state : {FailAwareState::kUnknown, FailAwareState::kOk, FailAwareState::kDegraded}) {
    EXPECT_FALSE(isAlarm(state));
  }
}

TEST(AlarmStatistics, LeadTimeIsFromTheFirstAlarmBeforeTheFailure) {
  const std::optional<LeadTime> lead = leadTime(madeUpEpisode("oodFFFFX", 7, 20.0));
  ASSERT_TRUE(lead);
  EXPECT_NEAR(lead->lead_s, 0.4, 1e-9);
  EXPECT_EQ(lead->speed_mps, 20.0);
  EXPECT_NEAR(leadTime(madeUpEpisode("oFoooX", 5))->lead_s, 0.4, 1e-9) << "though it went down again";
  EXPECT_TRUE(leadTime(madeUpEpisode("Fo", 1))) << "at t1 itself";
  EXPECT_FALSE(leadTime(madeUpEpisode("ooooX", 4))) << "with the failure is too late";
  EXPECT_FALSE(leadTime(madeUpEpisode("ooFF", -1))) << "no failure";
}

TEST(AlarmStatistics, CountsByHand) {
  const std::vector<FailAwareEpisode> episodes = {
      madeUpEpisode("UoooooFFFFXXXX", 10),  // 1.0 s watched, 0.4 s alarm, 0.1 s unknown
      madeUpEpisode("ooooo", 4),            // missed, 0.4 s
      madeUpEpisode("oodoooooFFo", -1),     // 1.0 s, 0.2 s alarm
  };
  const AlarmStatistics s = alarmStatistics(episodes, 0.25);
  EXPECT_EQ(s.episodes, 3u);
  EXPECT_EQ(s.failing, 2u);
  EXPECT_EQ(s.missed, 1u);
  EXPECT_DOUBLE_EQ(s.missedRatio(), 0.5);
  EXPECT_NEAR(s.watched_s, 2.4, 1e-9);
  EXPECT_NEAR(s.alarm_s, 0.6, 1e-9);
  EXPECT_NEAR(s.alarmRatio(), 0.25, 1e-9);
  EXPECT_NEAR(s.availableRatio(), 1.7 / 2.4, 1e-9);
  EXPECT_EQ(s.false_alarms, 1u) << "the first's, 0.4 s before its failure; the third's run ends 0.2 s after it";
  EXPECT_NEAR(s.falseAlarmsPerHour(), 3600.0 / 1.8, 1e-6);
  EXPECT_EQ(alarmStatistics(episodes, 0.45).false_alarms, 0u);
  EXPECT_EQ(alarmStatistics(episodes, 0.15).false_alarms, 2u);
}

TEST(AlarmStatistics, EveryRiseIsAnAlarm) {
  const AlarmStatistics s = alarmStatistics({madeUpEpisode("FoFFoFoooooooooooooo", -1)}, 0.5);
  EXPECT_EQ(s.false_alarms, 3u);
}

TEST(AlarmStatistics, SilenceIsAnAlarm) {
  FailAwareEpisode episode = madeUpEpisode("oooooX", 5);
  EXPECT_EQ(alarmStatistics({episode}).missed, 1u);
  episode.sweeps[3].silent_s = 0.07;  // of the 0.1 s to the next sweep
  EXPECT_NEAR(leadTime(episode)->lead_s, 0.17, 1e-9);
  const AlarmStatistics s = alarmStatistics({episode}, 0.15);
  EXPECT_EQ(s.missed, 0u);
  EXPECT_NEAR(s.alarm_s, 0.07, 1e-9);
  EXPECT_NEAR(s.watched_s, 0.5, 1e-9);
  EXPECT_EQ(s.false_alarms, 1u);
  EXPECT_EQ(alarmStatistics({episode}, 0.18).false_alarms, 0u) << "it rises 0.17 s before the failure";
  episode.sweeps[1].silent_s = 0.05;
  EXPECT_EQ(alarmStatistics({episode}, 0.15).false_alarms, 2u) << "the sweep between them ends the first";
  episode = madeUpEpisode("oooFFX", 5);
  episode.sweeps[4].silent_s = 0.07;
  EXPECT_NEAR(alarmStatistics({episode}).alarm_s, 0.2, 1e-9) << "up already";
}

TEST(AlarmStatistics, TheLeadMustSufficeForAStop) {
  // 4 m/s: 2 s at 2 m/s^2, 1 s at 4 m/s^2; the alarm comes 1.5 s before the failure
  const std::string states = "oooooFFFFFFFFFFFFFFFX";
  const AlarmStatistics s = alarmStatistics({madeUpEpisode(states, 20, 4.0), madeUpEpisode("ooooo", 4, 4.0)});
  EXPECT_DOUBLE_EQ(s.stopRatio(2.0), 0.0);
  EXPECT_DOUBLE_EQ(s.stopRatio(4.0), 0.5) << "a missed failure counts as none";
}

TEST(AlarmStatistics, WithoutEpisodesAllIsZero) {
  const AlarmStatistics s = alarmStatistics({});
  EXPECT_EQ(s.missedRatio(), 0.0);
  EXPECT_EQ(s.alarmRatio(), 0.0);
  EXPECT_EQ(s.falseAlarmsPerHour(), 0.0);
}

}  // namespace
}  // namespace fail_aware::alarm_statistics_test
