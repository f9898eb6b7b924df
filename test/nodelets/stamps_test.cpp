#include "../../src/nodelets/stamps.hpp"

#include <gtest/gtest.h>

namespace fail_aware::stamps_test {
namespace {

TEST(Stamps, DifferencesOverTheWholeRange) {
  EXPECT_EQ(secondsFrom(ros::Time(10, 0), ros::Time(10, 500000000)), 0.5);
  EXPECT_EQ(secondsFrom(ros::Time(10, 500000000), ros::Time(10, 0)), -0.5);
  EXPECT_NEAR(secondsFrom(ros::Time(), ros::TIME_MAX), 4294967296.0, 1.0);
  EXPECT_NEAR(secondsFrom(ros::TIME_MAX, ros::Time()), -4294967296.0, 1.0);
}

TEST(Stamps, LaterStaysWithinTheRange) {
  EXPECT_EQ(later(ros::Time(10, 0), 0.25), ros::Time(10, 250000000));
  EXPECT_EQ(later(ros::Time(10, 0), 0.0), ros::Time(10, 0));
  EXPECT_EQ(later(ros::TIME_MAX, 1.0), ros::TIME_MAX);
  EXPECT_EQ(later(ros::Time(10, 0), 1e10), ros::TIME_MAX);
}

TEST(Stamps, ZeroMalformedAndLastHourAreNotUsable) {
  EXPECT_TRUE(isUsableStamp(ros::Time(0, 1)));
  EXPECT_TRUE(isUsableStamp(ros::Time(ros::TIME_MAX.sec - 3601, 0)));
  EXPECT_FALSE(isUsableStamp(ros::Time()));
  EXPECT_FALSE(isUsableStamp(ros::TIME_MAX));
  ros::Time malformed(10, 0);
  malformed.nsec = 1000000000u;
  EXPECT_FALSE(isUsableStamp(malformed));
}

}  // namespace
}  // namespace fail_aware::stamps_test
