#include "evaluation/planner_figure.hpp"

#include <gtest/gtest.h>

#include "made_up_episode.hpp"

namespace fail_aware::planner_figure_test {
namespace {

constexpr double kDeceleration = 2.0;

/// One letter a second, as in madeUpEpisode; the time to failure is `time_s` throughout.
PlannerDrive drive(const std::string& states, double time_s, bool failed, double speed_mps = 10.0,
                   double time_to_failure_s = 60.0) {
  PlannerDrive made_up;
  made_up.time_s = time_s;
  made_up.failed = failed;
  for (const FailAwareSweep& sweep : madeUpEpisode(states, -1, speed_mps).sweeps) {
    made_up.seconds.push_back({static_cast<double>(made_up.seconds.size()),
                               TimeToFailure::fromSeconds(time_to_failure_s, 60.0), sweep.output.state,
                               sweep.speed_mps});
  }
  return made_up;
}

PlannerFigure figureOf(const PlannerDrive& one, StopRule rule = StopRule::kTimeOrState) {
  return plannerFigure({one}, kDeceleration, rule);
}

TEST(PlannerFigure, AStopHasToEndBeforeTheFailure) {
  // 10 m/s: 5 s
  const PlannerFigure in_time = figureOf(drive("ooooFFFFFFFF", 9.0, true));
  EXPECT_EQ(in_time.stoppable, 1u);
  EXPECT_EQ(in_time.in_time, 1u) << "from 4 s to 9 s";
  EXPECT_EQ(in_time.usedRatioOfFailing(), 1.0);
  const PlannerFigure late = figureOf(drive("oooooFFFFFFF", 9.0, true));
  EXPECT_EQ(late.stoppable, 1u);
  EXPECT_EQ(late.in_time, 0u);
  EXPECT_EQ(late.usedRatioOfFailing(), 1.0) << "not more than all";
  EXPECT_EQ(figureOf(drive("oooooooooooo", 9.0, true)).in_time, 0u);
  EXPECT_EQ(figureOf(drive("oooFFFFFFFFF", 12.0, true)).used_failing_s, 3.0);
  EXPECT_EQ(figureOf(drive("oooFFFFFFFFF", 12.0, true)).possible_failing_s, 7.0);
}

TEST(PlannerFigure, TheSlowestStopTakesASecond) {
  EXPECT_EQ(figureOf(drive("oooooFoo", 6.0, true, 0.5)).in_time, 1u);
  EXPECT_EQ(figureOf(drive("oooooFoo", 5.9, true, 0.5)).in_time, 0u);
}

TEST(PlannerFigure, ThePlannerLooksFromThreeSecondsOn) {
  EXPECT_EQ(figureOf(drive("FFFoooooo", 8.0, false)).sound_stopped, 0u);
  const PlannerFigure stopped = figureOf(drive("oooFooooo", 8.0, false));
  EXPECT_EQ(stopped.sound, 1u);
  EXPECT_EQ(stopped.sound_stopped, 1u);
  EXPECT_EQ(stopped.usedRatioOfSound(), 3.0 / 8.0);
  EXPECT_EQ(figureOf(drive("oo", 1.0, false)).sound, 0u) << "over before the first look";
}

TEST(PlannerFigure, TimeAndStateAreTwoRules) {
  const PlannerDrive by_time = drive("oooooooo", 7.0, false, 10.0, 5.0), by_state = drive("oooXoooo", 7.0, false);
  EXPECT_EQ(figureOf(by_time).sound_stopped, 1u) << "5 s left, 5 s needed";
  EXPECT_EQ(figureOf(by_time, StopRule::kTime).sound_stopped, 1u);
  EXPECT_EQ(figureOf(by_time, StopRule::kState).sound_stopped, 0u);
  EXPECT_EQ(figureOf(by_state).sound_stopped, 1u);
  EXPECT_EQ(figureOf(by_state, StopRule::kTime).sound_stopped, 0u);
  EXPECT_EQ(figureOf(by_state, StopRule::kState).sound_stopped, 1u);
  EXPECT_EQ(figureOf(drive("oooooooo", 7.0, false, 10.0, 5.1)).sound_stopped, 0u);
  EXPECT_EQ(figureOf(drive("oooUoooo", 7.0, false)).sound_stopped, 1u);
  PlannerDrive unknown = by_time;
  for (PlannerSecond& second : unknown.seconds) second.time_to_failure = TimeToFailure::unknown();
  EXPECT_EQ(figureOf(unknown, StopRule::kTime).sound_stopped, 0u) << "an unknown time is no time";
}

TEST(PlannerFigure, WhatNobodyCouldStopShouldBeToldAtOnce) {
  const PlannerFigure told = figureOf(drive("oooFFFFFF", 7.5, true));
  EXPECT_EQ(told.stoppable, 0u);
  EXPECT_EQ(told.unstoppable, 1u);
  EXPECT_EQ(told.told, 1u);
  EXPECT_EQ(figureOf(drive("ooooFFFFF", 7.5, true)).told, 0u);
  EXPECT_FALSE(told.usedRatio());
  EXPECT_EQ(figureOf(drive("oF", 1.5, true)).told, 1u) << "the run ends before the first look";
  EXPECT_EQ(figureOf(drive("oo", 1.5, true)).told, 0u);
  EXPECT_EQ(figureOf(drive("oo", 1.5, true, 10.0, 1.0)).told, 1u);
}

TEST(PlannerFigure, WhatIsSaidAfterAFailureDoesNotCount) {
  EXPECT_EQ(figureOf(drive("ooooFFFFFFF", 2.0, true)).told, 0u) << "before the first look";
  EXPECT_EQ(figureOf(drive("oFFooooo", 2.0, true)).told, 1u);
  PlannerDrive missed = drive("oooooooooooooooooXXX", 12.0, true, 4.0);
  for (std::size_t i = 13; i < missed.seconds.size(); ++i) missed.seconds[i].speed_mps = 20.0;
  missed.faults_s = {8.0};
  const PlannerFigure figure = figureOf(missed);
  EXPECT_EQ(figure.stoppable, 1u) << "a stop from 4 m/s takes 2 s";
  EXPECT_EQ(figure.in_time + figure.too_sudden, 0u);
  EXPECT_EQ(figure.possible_failing_s, 10.0);
}

TEST(PlannerFigure, AnEarlySuddenFaultIsNobodysFailure) {
  for (const char* const states : {"oo", "ooooooooo"}) {
    PlannerDrive early = drive(states, 1.5, true);
    early.faults_s = {0.8};
    EXPECT_EQ(figureOf(early).too_sudden, 1u) << states;
    EXPECT_EQ(figureOf(early).unstoppable, 0u) << states;
  }
}

TEST(PlannerFigure, ASuddenFaultIsNobodysFailure) {
  PlannerDrive sudden = drive("oooooooooooo", 11.0, true);
  sudden.faults_s = {-20.0, 7.0};
  const PlannerFigure apart = figureOf(sudden);
  EXPECT_EQ(apart.too_sudden, 1u);
  EXPECT_EQ(apart.stoppable + apart.unstoppable, 0u);
  sudden.faults_s = {-20.0, 6.0};
  EXPECT_EQ(figureOf(sudden).stoppable, 1u) << "5 s from the fault to the failure";
  for (std::size_t i = 0; i < 5; ++i) sudden.seconds[i].speed_mps = 1.0;
  sudden.faults_s = {7.0};
  EXPECT_EQ(figureOf(sudden).too_sudden, 1u) << "by the speed at the fault";
  sudden.faults_s = {11.5};
  EXPECT_EQ(figureOf(sudden).stoppable, 1u) << "after the failure";
}

TEST(PlannerFigure, BaselinesAreTheBestInHindsight) {
  const std::vector<PlannerDrive> drives = {drive("oooooooooooooooo", 12.0, true),
                                            drive("oooooooooooooooo", 14.0, true),
                                            drive("oooooooooooooooo", 15.0, false)};
  const FixedRule time = bestFixedTime(drives, kDeceleration, 2);
  EXPECT_EQ(time.value, 7.0) << "the first failure minus 5 s";
  EXPECT_EQ(time.figure.in_time, 2u);
  EXPECT_DOUBLE_EQ(*time.figure.usedRatio(), (7.0 + 7.0 + 7.0) / (7.0 + 9.0 + 15.0));
  EXPECT_EQ(bestFixedTime(drives, kDeceleration, 1).value, 9.0);
  EXPECT_EQ(bestFixedTime(drives, kDeceleration, 3).value, 3.0) << "as often as can be";
  const FixedRule distance = bestFixedDistance(drives, kDeceleration, 2);
  EXPECT_EQ(distance.value, 70.0) << "10 m/s";
  EXPECT_EQ(distance.figure.in_time, 2u);
}

TEST(PlannerFigure, AnEpisodeIsLookedAtOnceASecond) {
  FailAwareEpisode episode = madeUpEpisode(std::string(45, 'o'), 40);
  episode.begin_s = 100.0;
  episode.fault_begins_s = {-2.0, 2.5};
  episode.time_s = 4.0;
  episode.sweeps[31].output.state = FailAwareState::kFailed;
  episode.sweeps[31].output.time_to_failure = TimeToFailure::reached();
  const PlannerDrive judged = plannerDrive(episode);
  ASSERT_EQ(judged.seconds.size(), 5u);
  EXPECT_NEAR(judged.seconds[3].since_start_s, 3.0, 1e-9);
  for (const PlannerSecond& second : judged.seconds) EXPECT_EQ(second.state, FailAwareState::kOk);
  EXPECT_TRUE(judged.failed);
  EXPECT_EQ(judged.time_s, 4.0);
  EXPECT_EQ(judged.faults_s, (std::vector<double>{-2.0, 2.5}));
}

}  // namespace
}  // namespace fail_aware::planner_figure_test
