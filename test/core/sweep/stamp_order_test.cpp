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

TEST(StampOrder, WhatIsNoNumberNeitherAdvancesNorBeginsADrive) {
  EXPECT_EQ(stampOrder(std::numeric_limits<double>::quiet_NaN()), StampOrder::kReordered);
}

}  // namespace
}  // namespace fail_aware
