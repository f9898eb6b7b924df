#include "../../src/nodelets/sweep_matcher.hpp"

#include <gtest/gtest.h>

#include <boost/make_shared.hpp>
#include <cmath>

namespace fail_aware::sweep_matcher_test {
namespace {

namespace messages = ::fail_aware_lidar_odometry;

ros::Time stampOf(int i) { return ros::Time(100, 0) + ros::Duration(0.1 * i); }

sensor_msgs::PointCloud2ConstPtr cloud(int i) {
  const auto message = boost::make_shared<sensor_msgs::PointCloud2>();
  message->header.stamp = stampOf(i);
  return message;
}

SweepMatcher::Prediction prediction(int i, int previous) {
  const auto message = boost::make_shared<messages::SweepPrediction>();
  message->header.stamp = stampOf(i);
  if (previous >= 0) {
    message->previous_stamp = stampOf(previous);
    message->dt = 0.1 * (i - previous);
  }
  return message;
}

SweepMatcher::State state(int i) {
  const auto message = boost::make_shared<messages::FilterState>();
  message->header.stamp = stampOf(i);
  return message;
}

int measuredNow(SweepMatcher& matcher) {
  const std::optional<SweepMatcher::Job> job = matcher.next();
  if (!job) return -1;
  EXPECT_EQ(job->cloud->header.stamp, job->prediction->header.stamp);
  return static_cast<int>(std::lround((job->cloud->header.stamp - stampOf(0)).toSec() / 0.1));
}

TEST(SweepMatcher, NeedsPointsAndPredictionInAnyOrder) {
  SweepMatcher matcher;
  matcher.add(cloud(0));
  EXPECT_EQ(measuredNow(matcher), -1);
  matcher.add(prediction(0, -1));
  EXPECT_EQ(measuredNow(matcher), 0);
  EXPECT_EQ(measuredNow(matcher), -1) << "once";
  EXPECT_FALSE(matcher.takePlace());
  matcher.add(state(0));
  EXPECT_EQ(matcher.takePlace()->header.stamp, stampOf(0));
  EXPECT_FALSE(matcher.takePlace());
  matcher.add(prediction(1, 0));
  EXPECT_EQ(measuredNow(matcher), -1);
  matcher.add(cloud(1));
  EXPECT_EQ(measuredNow(matcher), 1);
}

TEST(SweepMatcher, WaitsForThePlaceOfTheSweepBefore) {
  SweepMatcher matcher;
  matcher.add(prediction(0, -1));
  matcher.add(cloud(0));
  EXPECT_EQ(measuredNow(matcher), 0);
  matcher.add(prediction(1, 0));
  matcher.add(cloud(1));
  EXPECT_EQ(measuredNow(matcher), -1);
  matcher.add(state(0));
  EXPECT_TRUE(matcher.takePlace());
  EXPECT_EQ(measuredNow(matcher), 1);
}

TEST(SweepMatcher, WhoFellBehindSkipsToTheNewestSweep) {
  SweepMatcher matcher;
  matcher.add(prediction(0, -1));
  matcher.add(cloud(0));
  EXPECT_EQ(measuredNow(matcher), 0);
  for (int i = 0; i < 5; ++i) {  // while sweep 0 was measured
    matcher.add(state(i));
    matcher.add(prediction(i + 1, i));
    matcher.add(cloud(i + 1));
  }
  EXPECT_EQ(matcher.takePlace()->header.stamp, stampOf(0));
  const std::optional<SweepMatcher::Job> job = matcher.next();
  ASSERT_TRUE(job);
  EXPECT_EQ(job->prediction->header.stamp, stampOf(5));
  ASSERT_EQ(job->skipped.size(), 4u) << "their states";
  for (int i = 0; i < 4; ++i) EXPECT_EQ(job->skipped[static_cast<std::size_t>(i)]->header.stamp, stampOf(i + 1));
  EXPECT_EQ(matcher.skipped(), 4u);
  EXPECT_EQ(measuredNow(matcher), -1);
}

TEST(SweepMatcher, APlaceThatWasLostHoldsNobodyUp) {
  SweepMatcher matcher;
  matcher.add(prediction(0, -1));
  matcher.add(cloud(0));
  EXPECT_EQ(measuredNow(matcher), 0);
  matcher.add(prediction(2, 1));  // the filter went on without us; state 0 never came
  matcher.add(cloud(2));
  EXPECT_EQ(measuredNow(matcher), 2);
}

TEST(SweepMatcher, ADriveThatBeginsForgetsTheStatesOfTheLast) {
  SweepMatcher matcher;
  matcher.add(prediction(0, -1));
  matcher.add(cloud(0));
  EXPECT_EQ(measuredNow(matcher), 0);
  matcher.add(state(0));
  matcher.add(prediction(0, -1));  // a bag begins again: the same stamps
  EXPECT_FALSE(matcher.takePlace()) << "that state was the last drive's";
  matcher.add(cloud(0));
  EXPECT_EQ(measuredNow(matcher), 0);
}

TEST(SweepMatcher, ADriveBeginsAlsoWhenItsFirstSweepIsSkipped) {
  SweepMatcher matcher;
  matcher.add(prediction(3, 2));
  matcher.add(cloud(3));
  EXPECT_FALSE(matcher.next()->begins);
  for (int i = 0; i < 2; ++i) {  // while sweep 3 was measured, another drive began
    matcher.add(prediction(i, i - 1));
    matcher.add(cloud(i));
  }
  const std::optional<SweepMatcher::Job> job = matcher.next();
  ASSERT_TRUE(job);
  EXPECT_EQ(job->prediction->header.stamp, stampOf(1));
  EXPECT_TRUE(job->begins) << "the last drive's references must go";
  matcher.add(prediction(2, 0));
  matcher.add(cloud(2));
  EXPECT_FALSE(matcher.next()->begins) << "told once";
}

}  // namespace
}  // namespace fail_aware::sweep_matcher_test
