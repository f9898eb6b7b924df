#include "core/estimation/stamp_order.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace fail_aware::stamp_order_test {
namespace {

StampOrder first(double since_newest_s) { return StampSequence().next(since_newest_s); }

TEST(StampSequence, TellsALateSweepFromAClockThatWasSetBack) {
  EXPECT_EQ(first(1e-6), StampOrder::kAdvances);
  EXPECT_EQ(first(0.0), StampOrder::kSame);
  EXPECT_EQ(first(-1e-6), StampOrder::kReordered);
  EXPECT_EQ(first(-kMaxReorder_s), StampOrder::kReordered);
  EXPECT_EQ(first(-kMaxReorder_s - 1e-6), StampOrder::kFarBack);
}

TEST(StampSequence, AStampFarBackCountsOnceTheNextOneFollowsOnIt) {
  StampSequence stamps;
  EXPECT_EQ(stamps.next(-3600.0), StampOrder::kFarBack);
  EXPECT_EQ(stamps.next(0.1), StampOrder::kAdvances) << "it was wrong";
  EXPECT_EQ(stamps.setBack_s(), 0.0);
  EXPECT_EQ(stamps.next(-2.0), StampOrder::kFarBack);
  EXPECT_EQ(stamps.next(-2.0), StampOrder::kFarBack) << "the same one again";
  EXPECT_EQ(stamps.next(-2.1), StampOrder::kFarBack) << "before it";
  EXPECT_EQ(stamps.next(-2.0), StampOrder::kJumpedBack);
}

TEST(StampSequence, FarAheadAndFarBackDoNotConfirmEachOther) {
  StampSequence stamps;
  EXPECT_EQ(stamps.next(7200.0), StampOrder::kFarAhead);
  EXPECT_EQ(stamps.next(-2.0), StampOrder::kFarBack);
  EXPECT_EQ(stamps.next(7200.1), StampOrder::kFarAhead);
}

TEST(StampSequence, AStampFarAheadCountsOnceTheNextOneFollowsOnIt) {
  EXPECT_EQ(first(kFarAhead_s), StampOrder::kAdvances);
  EXPECT_EQ(first(kFarAhead_s + 1e-6), StampOrder::kFarAhead);
  StampSequence stamps;
  EXPECT_EQ(stamps.next(7200.0), StampOrder::kFarAhead);
  EXPECT_EQ(stamps.next(7200.0), StampOrder::kFarAhead) << "the same one again";
  EXPECT_EQ(stamps.next(7199.9), StampOrder::kFarAhead) << "before it";
  EXPECT_EQ(stamps.next(1e6), StampOrder::kFarAhead) << "another one";
  EXPECT_EQ(stamps.next(1e6 + 0.1), StampOrder::kJumpedAhead);
}

TEST(StampSequence, AStampFarAheadIsForgottenOnceOneComesThatIsNot) {
  for (const double wrong_before_s : {0.1, 0.0, -0.1}) {
    StampSequence stamps;
    EXPECT_EQ(stamps.next(7200.0), StampOrder::kFarAhead);
    EXPECT_NE(stamps.next(wrong_before_s), StampOrder::kFarAhead);
    EXPECT_EQ(stamps.next(7200.1), StampOrder::kFarAhead);
  }
  StampSequence stamps;
  EXPECT_EQ(stamps.next(7200.0), StampOrder::kFarAhead);
  stamps.beginDrive();
  EXPECT_EQ(stamps.next(7200.1), StampOrder::kFarAhead);
}

TEST(StampSequence, WhatIsNoNumberNeitherAdvancesNorBeginsADrive) {
  StampSequence stamps;
  EXPECT_EQ(stamps.next(std::numeric_limits<double>::quiet_NaN()), StampOrder::kReordered);
  EXPECT_EQ(stamps.next(0.1), StampOrder::kAdvances);
  EXPECT_EQ(stamps.setBack_s(), 0.0);
  EXPECT_EQ(stamps.next(std::numeric_limits<double>::infinity()), StampOrder::kFarAhead);
  EXPECT_EQ(stamps.next(std::numeric_limits<double>::infinity()), StampOrder::kFarAhead);
}

TEST(StampSequence, ALimitThatChangesKeepsWhatCameBefore) {
  StampSequence stamps;
  EXPECT_EQ(stamps.next(-0.3), StampOrder::kReordered);
  stamps.setMaxReorder(0.2);
  EXPECT_EQ(stamps.next(-0.3), StampOrder::kFarBack);
  EXPECT_EQ(stamps.next(0.1), StampOrder::kAdvances);
  EXPECT_EQ(stamps.setBack_s(), 0.3);
}

TEST(StampSequence, SetBackIsTheLargestRefused) {
  StampSequence stamps;
  EXPECT_EQ(stamps.setBack_s(), 0.0);
  for (const double since_newest_s : {-0.3, -0.2, 0.0, 7200.0}) stamps.next(since_newest_s);
  EXPECT_EQ(stamps.setBack_s(), 0.0) << "of the one that was taken before them";
  stamps.next(0.1);
  EXPECT_EQ(stamps.setBack_s(), 0.3);
  stamps.next(0.1);
  EXPECT_EQ(stamps.setBack_s(), 0.0);
  for (const double since_newest_s : {-0.3, 0.1, -0.2, -7200.0, -7199.9}) stamps.next(since_newest_s);
  stamps.beginDrive();
  EXPECT_EQ(stamps.setBack_s(), 0.0) << "a new drive";
  stamps.next(0.1);
  EXPECT_EQ(stamps.setBack_s(), 0.0);
  EXPECT_EQ(stamps.next(0.0), StampOrder::kSame);
  stamps.next(0.1);
  EXPECT_GT(stamps.setBack_s(), 0.0) << "the clock may have been set back by a period";
  for (int i = 0; i < 3; ++i) {
    stamps.next(0.0);
    stamps.next(0.1);
    EXPECT_EQ(stamps.setBack_s(), 0.0) << "each cloud comes twice";
  }
  stamps.next(0.1);
  stamps.next(-0.2);
  stamps.next(0.1);
  EXPECT_EQ(stamps.setBack_s(), 0.2);
}

}  // namespace
}  // namespace fail_aware::stamp_order_test
