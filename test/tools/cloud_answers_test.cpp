#include "../../src/tools/cloud_answers.hpp"

#include <gtest/gtest.h>

namespace fail_aware::cloud_answers_test {
namespace {

TEST(CloudAnswers, MeasuresFromCloudToOdometryOfTheSameStamp) {
  CloudAnswers answers;
  answers.cloud(1, 10.0);
  answers.cloud(2, 10.1);
  answers.odometry(1, 10.15);
  answers.odometry(2, 10.17);
  ASSERT_EQ(answers.latencies_s().size(), 2u);
  EXPECT_NEAR(answers.latencies_s()[0], 0.15, 1e-12);
  EXPECT_NEAR(answers.latencies_s()[1], 0.07, 1e-12);
  EXPECT_EQ(answers.unanswered(), 0u);
}

TEST(CloudAnswers, CountsCloudsWithoutAnswer) {
  CloudAnswers answers(5.0);
  answers.cloud(1, 0.0);
  answers.cloud(2, 1.0);
  answers.odometry(2, 1.1);
  answers.cloud(2, 2.0);  // again
  answers.cloud(2, 2.1);
  EXPECT_EQ(answers.unanswered(), 3u);
  answers.cloud(3, 8.0);
  EXPECT_EQ(answers.unanswered(), 4u);
  answers.odometry(3, 8.1);
  EXPECT_EQ(answers.unanswered(), 3u);
  EXPECT_EQ(answers.clouds(), 5u);
  EXPECT_EQ(answers.odometries(), 2u);
}

TEST(CloudAnswers, AnAnswerAheadOfItsCloudIsOne) {
  CloudAnswers answers;
  answers.odometry(7, 1.0);
  answers.cloud(7, 1.001);
  EXPECT_EQ(answers.unanswered(), 0u);
  ASSERT_EQ(answers.latencies_s().size(), 1u);
  EXPECT_EQ(answers.latencies_s()[0], 0.0);
}

}  // namespace
}  // namespace fail_aware::cloud_answers_test
