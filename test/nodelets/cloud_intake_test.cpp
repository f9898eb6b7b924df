#include "../../src/nodelets/cloud_intake.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace fail_aware::cloud_intake_test {
namespace {

class CloudIntakeTest : public testing::Test {
 protected:
  CloudIntakeTest() { ros::Time::init(); }

  /// A cloud without a frame has no place, whatever tf knows.
  void take(std::uint32_t sequence, const std::string& frame) {
    std_msgs::Header header;
    header.seq = sequence;
    header.stamp = ros::Time(100 + sequence, 0);
    header.frame_id = frame;
    clouds_.take(header);
  }

  SweepScheduler scheduler_;
  std::vector<std::uint32_t> accepted_;
  CloudIntake clouds_{scheduler_, [this](const std_msgs::Header& header) { accepted_.push_back(header.seq); }};
};

TEST_F(CloudIntakeTest, CloudsOfAKnownPlaceGoOn) {
  clouds_.lidar().use(Pose::Identity());
  EXPECT_TRUE(clouds_.heardAt().isZero());
  take(1, "velodyne");
  take(2, "velodyne");
  EXPECT_EQ(accepted_, (std::vector<std::uint32_t>{1, 2}));
  EXPECT_FALSE(clouds_.heardAt().isZero());
}

TEST_F(CloudIntakeTest, AnotherFrameIsRefused) {
  clouds_.lidar().use(Pose::Identity());
  take(1, "velodyne");
  take(2, "radar");
  EXPECT_EQ(accepted_, std::vector<std::uint32_t>{1});
  EXPECT_EQ(scheduler_.counts().wrong_frame, 1u);
}

TEST_F(CloudIntakeTest, TheLastThreeWaitForThePlace) {
  for (const std::uint32_t sequence : {1, 2, 3, 4, 5}) take(sequence, "");
  clouds_.retry();
  EXPECT_TRUE(accepted_.empty());
  EXPECT_NE(clouds_.lidar().fault(), "");
  EXPECT_EQ(clouds_.lost(), 2u);
  clouds_.lidar().use(Pose::Identity());
  clouds_.retry();
  EXPECT_EQ(accepted_, (std::vector<std::uint32_t>{3, 4, 5}));
  clouds_.retry();
  EXPECT_EQ(accepted_.size(), 3u) << "once";
}

TEST_F(CloudIntakeTest, WaitingCloudsGoFirst) {
  take(1, "");
  clouds_.lidar().use(Pose::Identity());
  take(2, "");
  EXPECT_EQ(accepted_, (std::vector<std::uint32_t>{1, 2}));
}

TEST_F(CloudIntakeTest, WhatWaitedInAnotherFrameIsRefused) {
  take(1, "");
  clouds_.lidar().use(Pose::Identity());
  take(2, "velodyne");
  EXPECT_EQ(accepted_, std::vector<std::uint32_t>{2});
  EXPECT_EQ(scheduler_.counts().wrong_frame, 1u);
}

TEST_F(CloudIntakeTest, ANewDriveLosesWhatWaits) {
  take(1, "");
  take(2, "");
  clouds_.clear();
  EXPECT_EQ(clouds_.lost(), 2u);
  clouds_.lidar().use(Pose::Identity());
  clouds_.retry();
  EXPECT_TRUE(accepted_.empty());
}

}  // namespace
}  // namespace fail_aware::cloud_intake_test
