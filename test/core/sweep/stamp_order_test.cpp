#include "fail_aware_lidar_odometry/core/sweep/stamp_order.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace fail_aware {
namespace {

TEST(StampOrder, TellsALateSweepFromAClockThatWasSetBack) {
  EXPECT_EQ(stampOrder(1e-6), StampOrder::kAdvances);
  EXPECT_EQ(stampOrder(0.0), StampOrder::kSame);
  EXPECT_EQ(stampOrder(-1e-6), StampOrder::kReordered);
  EXPECT_EQ(stampOrder(-kMaxReorder_s), StampOrder::kReordered);
  EXPECT_EQ(stampOrder(-kMaxReorder_s - 1e-6), StampOrder::kJumpedBack);
  EXPECT_EQ(stampOrder(-1e-6, 0.0), StampOrder::kJumpedBack);
}

TEST(StampOrder, AStampFarAheadCountsOnceTheNextOneFollowsOnIt) {
  EXPECT_EQ(stampOrder(kFarAhead_s), StampOrder::kAdvances);
  EXPECT_EQ(stampOrder(kFarAhead_s + 1e-6), StampOrder::kFarAhead);
  EXPECT_EQ(stampOrder(7200.1, kMaxReorder_s, 0.1), StampOrder::kJumpedAhead);
  EXPECT_EQ(stampOrder(7200.0, kMaxReorder_s, 0.0), StampOrder::kFarAhead) << "the same one again";
  EXPECT_EQ(stampOrder(7200.0, kMaxReorder_s, -0.1), StampOrder::kFarAhead);
  EXPECT_EQ(stampOrder(1e9, kMaxReorder_s, 1e6), StampOrder::kFarAhead) << "another one";
  EXPECT_EQ(stampOrder(0.2, kMaxReorder_s, -7200.0), StampOrder::kAdvances) << "it was wrong";
}

TEST(StampOrder, WhatIsNoNumberNeitherAdvancesNorBeginsADrive) {
  EXPECT_EQ(stampOrder(std::numeric_limits<double>::quiet_NaN()), StampOrder::kReordered);
}

TEST(SetBack, IsTheMostOfTheStampsThatWereOutOfOrderAndToldOnce) {
  SetBack set_back;
  EXPECT_EQ(set_back.take_s(), 0.0);
  set_back.refused(StampOrder::kReordered, -0.3);
  set_back.refused(StampOrder::kReordered, -0.2);
  set_back.refused(StampOrder::kReordered, std::numeric_limits<double>::quiet_NaN());
  set_back.refused(StampOrder::kFarAhead, 7200.0);
  set_back.refused(StampOrder::kJumpedBack, -7200.0);
  EXPECT_EQ(set_back.take_s(), 0.3);
  EXPECT_EQ(set_back.take_s(), 0.0);
}

}  // namespace
}  // namespace fail_aware
