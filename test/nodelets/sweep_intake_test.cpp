#include "../../src/nodelets/sweep_intake.hpp"

#include <gtest/gtest.h>

namespace fail_aware {
namespace {

using Verdict = SweepIntake::Verdict;

std_msgs::Header at(double stamp_s) {
  std_msgs::Header header;
  header.stamp = ros::Time(stamp_s);
  return header;
}

TEST(SweepIntake, SweepsComeOutInTheirOrder) {
  SweepIntake intake;
  EXPECT_FALSE(intake.next());
  for (const double stamp_s : {10.0, 10.1, 10.2}) EXPECT_EQ(intake.offer(at(stamp_s)), Verdict::kQueued);
  for (const double stamp_s : {10.0, 10.1, 10.2}) EXPECT_EQ(intake.next()->header.stamp, ros::Time(stamp_s));
  EXPECT_FALSE(intake.next());
  EXPECT_EQ(intake.takeDropped(), 0);
}

TEST(SweepIntake, EachSweepKeepsTheTimeOfItsArrival) {
  SweepIntake intake;
  intake.offer(at(10.0), ros::SteadyTime(3.0));
  intake.offer(at(10.1), ros::SteadyTime(3.5));
  EXPECT_EQ(intake.next()->arrived, ros::SteadyTime(3.0));
  EXPECT_EQ(intake.next()->arrived, ros::SteadyTime(3.5));
}

TEST(SweepIntake, OverloadDropsTheOldestAndCountsIt) {
  SweepIntake intake;
  intake.setLimits(3, 0.5);
  for (int i = 0; i < 4; ++i) intake.offer(at(10.0 + 0.1 * i));
  EXPECT_EQ(intake.counts().overload, 2u) << "two may wait now";
  EXPECT_EQ(intake.takeDropped(), 2);
  EXPECT_EQ(intake.takeDropped(), 0) << "told once";
  EXPECT_EQ(intake.next()->header.stamp, ros::Time(10.2));
}

TEST(SweepIntake, WhoCannotFollowForLongGetsTheNewestUntilHeHasCaughtUp) {
  SweepIntake intake;
  intake.setLimits(3, 0.5);
  int i = 0;
  const auto offer = [&](int sweeps) {
    for (int k = 0; k < sweeps; ++k) intake.offer(at(10.0 + 0.1 * i++));
  };
  offer(6);
  for (int round = 0; round < 3; ++round) {
    offer(2);
    EXPECT_EQ(intake.next()->header.stamp, ros::Time(10.0 + 0.1 * (i - 1))) << "the newest";
  }
  EXPECT_EQ(intake.counts().overload, 9u);
  EXPECT_FALSE(intake.next()) << "caught up";
  offer(3);
  EXPECT_EQ(intake.counts().overload, 9u) << "three may wait again";
  EXPECT_EQ(intake.next()->header.stamp, ros::Time(10.0 + 0.1 * (i - 3)));
}

TEST(SweepIntake, StampsThatDoNotAdvanceAreRefusedByTheirCause) {
  SweepIntake intake;
  intake.offer(at(10.0));
  EXPECT_EQ(intake.offer(at(10.0)), Verdict::kRefused);
  EXPECT_EQ(intake.offer(at(9.5)), Verdict::kRefused) << "half a second back is a sweep out of order";
  EXPECT_EQ(intake.offer(at(0.0)), Verdict::kRefused);
  intake.refuseFrame();
  EXPECT_EQ(intake.counts().duplicate, 1u);
  EXPECT_EQ(intake.counts().reordered, 1u);
  EXPECT_EQ(intake.counts().unusable_stamp, 1u);
  EXPECT_EQ(intake.counts().wrong_frame, 1u);
  EXPECT_EQ(intake.takeDropped(), 4);
}

TEST(SweepIntake, TheNextSweepTellsHowFarStampsWereSetBackBeforeIt) {
  SweepIntake intake;
  for (const double stamp_s : {10.0, 9.75, 9.85, 9.95, 10.125, 10.25}) intake.offer(at(stamp_s));
  EXPECT_EQ(intake.next()->set_back_s, 0.0);
  EXPECT_EQ(intake.next()->set_back_s, 0.25);
  EXPECT_EQ(intake.next()->set_back_s, 0.0);
  intake.offer(at(10.0));
  intake.clear();
  intake.offer(at(20.0));
  EXPECT_EQ(intake.next()->set_back_s, 0.0) << "a new drive";
  intake.setLimits(1, 0.5);
  for (const double stamp_s : {19.75, 20.125, 20.25}) intake.offer(at(stamp_s));
  EXPECT_EQ(intake.counts().overload, 1u);
  EXPECT_EQ(intake.next()->set_back_s, 0.25) << "told by the next one, if that one is dropped";
}

TEST(SweepIntake, AStampOfTheEndOfTimeIsRefused) {
  SweepIntake intake;
  std_msgs::Header end;
  end.stamp = ros::TIME_MAX;
  EXPECT_EQ(intake.offer(end), Verdict::kRefused) << "the first one, too";
  end.stamp.sec -= 3600;
  EXPECT_EQ(intake.offer(end), Verdict::kRefused) << "tf2 adds to it";
  std_msgs::Header not_normal = at(10.0);
  not_normal.stamp.nsec = 0xffffffff;  // as it may come off the wire
  EXPECT_EQ(intake.offer(not_normal), Verdict::kRefused);
  EXPECT_EQ(intake.counts().unusable_stamp, 3u);
  EXPECT_EQ(intake.lastRefused(), "stamp not usable");
}

TEST(SweepIntake, OneStampFarAheadIsRefusedASecondOneBeginsADrive) {
  SweepIntake intake;
  intake.setLimits(3, 0.5);
  intake.offer(at(10.0));
  EXPECT_EQ(intake.offer(at(7210.0)), Verdict::kRefused);
  EXPECT_EQ(intake.offer(at(10.2)), Verdict::kQueued) << "the drive goes on";
  EXPECT_EQ(intake.offer(at(7210.1)), Verdict::kRefused) << "what came in between spoke against it";
  EXPECT_EQ(intake.counts().far_ahead, 2u);
  EXPECT_EQ(intake.takeDropped(), 2);
  EXPECT_EQ(intake.offer(at(7210.2)), Verdict::kNewDrive);
  EXPECT_NEAR(intake.since_newest_s(ros::Time(7210.2)), 7200.0, 1e-6);
  intake.clear();
  EXPECT_EQ(intake.offer(at(7210.2)), Verdict::kQueued);
}

TEST(SweepIntake, AJumpBackIsToldAndTheCloudIsTakenOnceCleared) {
  SweepIntake intake;
  intake.offer(at(10.0));
  EXPECT_EQ(intake.offer(at(9.4)), Verdict::kNewDrive);
  EXPECT_NEAR(intake.since_newest_s(ros::Time(9.4)), -0.6, 1e-9);
  intake.clear(true);
  EXPECT_EQ(intake.counts().reset, 2u) << "what waited and what was in work";
  EXPECT_EQ(intake.offer(at(9.4)), Verdict::kQueued);
  EXPECT_EQ(intake.next()->header.stamp, ros::Time(9.4));
  EXPECT_FALSE(intake.next()) << "what waited before the jump is gone";
  EXPECT_EQ(intake.takeDropped(), 0);
}

}  // namespace
}  // namespace fail_aware
