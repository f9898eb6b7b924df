// The live simulator: every sweep of its drive arrives, as a Velodyne's, with place and truth. Waits for messages only.
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_msgs/TFMessage.h>

#include <string>
#include <vector>

#include "../support/graph_recorder.hpp"
#include "core/types/corrected_sweep.hpp"
#include "fail_aware_lidar_odometry/bridge/point_cloud_conversion.hpp"

namespace fail_aware::drive_simulator_test {
namespace {

/// In the order of arrival.
template <class Message>
struct Arrivals {
  Arrivals(ros::NodeHandle& node, const std::string& topic)
      : subscriber(node.subscribe<Message>(
            topic, 100, [this](const typename Message::ConstPtr& message) { messages.push_back(message); })) {}

  bool connected() const { return subscriber.getNumPublishers() > 0; }

  std::vector<typename Message::ConstPtr> messages;
  ros::Subscriber subscriber;
};

TEST(DriveSimulator, PublishesItsDrive) {
  ros::NodeHandle node;
  Arrivals<tf2_msgs::TFMessage> places(node, "/tf_static");
  Arrivals<nav_msgs::Odometry> truths(node, "/ground_truth/odometry");
  ASSERT_TRUE(waitFor([&] { return places.connected() && truths.connected(); }));
  Arrivals<sensor_msgs::PointCloud2> clouds(node, "/velodyne_points");  // last: the drive begins
  const std::size_t expected = 15 + 2;
  ASSERT_TRUE(waitFor([&] {
    return clouds.messages.size() >= expected && truths.messages.size() >= expected && !places.messages.empty();
  }));
  const auto& transform = places.messages[0]->transforms.at(0);
  EXPECT_EQ(transform.header.frame_id, "base_link");
  EXPECT_EQ(transform.child_frame_id, "velodyne");
  EXPECT_DOUBLE_EQ(transform.transform.translation.z, 1.73);

  std::size_t empty = 0, same_stamp = 0;
  for (std::size_t i = 0; i < expected; ++i) {
    const sensor_msgs::PointCloud2& cloud = *clouds.messages[i];
    EXPECT_EQ(cloud.header.frame_id, "velodyne");
    EXPECT_EQ(cloud.header.stamp, truths.messages[i]->header.stamp);
    Sweep sweep;
    if (!readCloud(cloud, sweep).ok()) {
      ++empty;
      continue;
    }
    EXPECT_GT(sweep.size(), 50000u);
    EXPECT_LE(sweep.times_s.back(), 0.0f);
    EXPECT_NEAR(sweep.times_s.front(), -0.1f, 2e-3f);
    if (i == 0) continue;
    const double period_s = (cloud.header.stamp - clouds.messages[i - 1]->header.stamp).toSec();
    if (period_s == 0.0) {
      ++same_stamp;
    } else {
      EXPECT_NEAR(period_s, 0.1, 1e-6);
    }
  }
  EXPECT_EQ(empty, 1u);
  EXPECT_EQ(same_stamp, 2u);
  const auto& last = truths.messages[expected - 1]->pose.pose.position;
  EXPECT_GT(last.x, 13.0);
}

}  // namespace
}  // namespace fail_aware::drive_simulator_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "drive_simulator_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
