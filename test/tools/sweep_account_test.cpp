#include "../../src/tools/sweep_account.hpp"

#include <gtest/gtest.h>

namespace fail_aware {
namespace {

TEST(SweepAccount, measuresFromCloudToOdometryOfTheSameStamp) {
  SweepAccount account;
  account.cloud(1, 10.0);
  account.cloud(2, 10.1);
  account.odometry(1, 10.15);
  account.odometry(2, 10.17);
  ASSERT_EQ(account.latencies_s().size(), 2u);
  EXPECT_NEAR(account.latencies_s()[0], 0.15, 1e-12);
  EXPECT_NEAR(account.latencies_s()[1], 0.07, 1e-12);
  EXPECT_EQ(account.unanswered(), 0u);
}

TEST(SweepAccount, countsCloudsWithoutAnswer) {
  SweepAccount account(5.0);
  account.cloud(1, 0.0);
  account.cloud(2, 1.0);
  account.odometry(2, 1.1);
  account.cloud(2, 2.0);  // again
  account.cloud(2, 2.1);
  EXPECT_EQ(account.unanswered(), 3u);
  account.cloud(3, 8.0);
  EXPECT_EQ(account.unanswered(), 4u);
  account.odometry(3, 8.1);
  EXPECT_EQ(account.unanswered(), 3u);
  EXPECT_EQ(account.clouds(), 5u);
  EXPECT_EQ(account.odometries(), 2u);
}

TEST(SweepAccount, anAnswerAheadOfItsCloudIsOne) {
  SweepAccount account;
  account.odometry(7, 1.0);
  account.cloud(7, 1.001);
  EXPECT_EQ(account.unanswered(), 0u);
  ASSERT_EQ(account.latencies_s().size(), 1u);
  EXPECT_EQ(account.latencies_s()[0], 0.0);
}

}  // namespace
}  // namespace fail_aware
