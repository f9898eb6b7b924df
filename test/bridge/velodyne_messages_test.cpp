#include "bridge/velodyne_messages.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/types/corrected_sweep.hpp"
#include "fail_aware_lidar_odometry/bridge/point_cloud_conversion.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"

namespace fail_aware::velodyne_messages_test {
namespace {

Sweep driverSweep() {
  Sweep sweep;
  sweep.stamp_s = 0.2;
  sweep.points_lidar = {{1, 2, 3}, {-4, 5, 6.5f}};
  sweep.intensities = {10.0f, 250.0f};
  sweep.times_s = {-0.09f, -0.01f};
  sweep.rings = {0, 63};
  return sweep;
}

TEST(VelodyneMessages, CloudHasTheDriversLayoutAndReadsBack) {
  sensor_msgs::PointCloud2 cloud;
  writeVelodyneCloud(driverSweep(), cloud);
  EXPECT_EQ(cloud.point_step, 22u);
  EXPECT_EQ(cloud.data.size(), 44u);
  ASSERT_EQ(cloud.fields.size(), 6u);
  EXPECT_EQ(cloud.fields[4].name, "ring");
  EXPECT_EQ(cloud.fields[4].datatype, sensor_msgs::PointField::UINT16);
  EXPECT_EQ(cloud.fields[5].offset, 18u);
  Sweep back;
  ASSERT_TRUE(readCloud(cloud, back).ok());
  const Sweep sweep = driverSweep();
  EXPECT_EQ(back.points_lidar, sweep.points_lidar);
  EXPECT_EQ(back.intensities, sweep.intensities);
  EXPECT_EQ(back.times_s, sweep.times_s);
  EXPECT_EQ(back.rings, sweep.rings);
}

TEST(VelodyneMessages, EmptyNanAndMissingArrays) {
  sensor_msgs::PointCloud2 cloud;
  writeVelodyneCloud(Sweep(), cloud);
  EXPECT_EQ(cloud.width, 0u);
  EXPECT_EQ(cloud.fields.size(), 6u);
  Sweep sweep;
  sweep.points_lidar = {{1, 2, 3}, Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN())};
  writeVelodyneCloud(sweep, cloud);
  EXPECT_FALSE(cloud.is_dense);
  Sweep back;
  ASSERT_TRUE(readCloud(cloud, back).ok());
  EXPECT_EQ(back.points_dropped, 1u);
  EXPECT_EQ(back.times_s, (std::vector<float>{0.0f}));
}

TEST(VelodyneMessages, TimesKeepMicroseconds) {
  const ros::Time epoch(1577836800, 0);
  EXPECT_EQ(timeAt(epoch, 0.1), ros::Time(1577836800, 100000000));
  EXPECT_EQ(timeAt(epoch, 0.3), ros::Time(1577836800, 300000000));
  EXPECT_EQ(timeAt(epoch, -4.9), ros::Time(1577836795, 100000000));
}

TEST(VelodyneMessages, PlaceAndTruth) {
  Pose T = Pose::Identity();
  T.translation() << -0.5, 0.25, 1.75;
  const VelodyneNames names;
  const ros::Time stamp(5, 6);
  const geometry_msgs::TransformStamped place = lidarPlace(T, names, stamp);
  EXPECT_EQ(place.header.frame_id, "base_link");
  EXPECT_EQ(place.child_frame_id, "velodyne");
  EXPECT_TRUE(fromMessage(place.transform)->isApprox(T));
  const nav_msgs::Odometry truth = groundTruth(T, names, stamp);
  EXPECT_EQ(truth.header.frame_id, "ground_truth");
  EXPECT_EQ(truth.child_frame_id, "base_link");
  EXPECT_EQ(truth.header.stamp, stamp);
  EXPECT_TRUE(fromMessage(truth.pose.pose)->isApprox(T));
}

}  // namespace
}  // namespace fail_aware::velodyne_messages_test
