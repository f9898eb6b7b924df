#include "bridge/velodyne_bag_writer.hpp"

#include <gtest/gtest.h>
#include <rosbag/view.h>
#include <tf2_msgs/TFMessage.h>
#include <unistd.h>

#include <filesystem>

#include "bridge/bag_sweep_source.hpp"
#include "core/io/input_error.hpp"

namespace fail_aware::velodyne_bag_writer_test {
namespace {

namespace fs = std::filesystem;

class VelodyneBagWriterTest : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = (fs::path(::testing::TempDir()) / ("velodyne_bag_writer_" + std::to_string(getpid()) + ".bag")).string();
    T_base_lidar_.translation() << -0.595, 0.0, 1.73;
  }
  void TearDown() override { fs::remove(path_); }

  static Sweep sweepAt(double stamp_s) {
    Sweep sweep;
    sweep.stamp_s = stamp_s;
    sweep.points_lidar = {{1, 2, 3}, {4, 5, 6}};
    sweep.intensities = {1, 2};
    sweep.times_s = {-0.1f, 0.0f};
    sweep.rings = {1, 2};
    return sweep;
  }

  std::string path_;
  Pose T_base_lidar_ = Pose::Identity();
};

TEST_F(VelodyneBagWriterTest, ReadsBackAsASourceOfSweeps) {
  VelodyneBagWriter writer(path_, T_base_lidar_);
  Pose T = Pose::Identity();
  for (int i = 1; i <= 3; ++i) {
    T.translation().x() = 10.0 + i;
    writer.add(sweepAt(0.1 * i), T, 0.1 * i);
  }
  writer.close();
  BagSweepSource source({path_});
  EXPECT_EQ(source.topic(), "/velodyne_points");
  EXPECT_EQ(source.size(), 3u);
  ASSERT_TRUE(source.lidarInBase("base_link").T_base_lidar.has_value());
  EXPECT_TRUE(source.lidarInBase("base_link").T_base_lidar->isApprox(T_base_lidar_));
  Sweep sweep;
  ASSERT_EQ(source.next(sweep).status, ReadStatus::kOk);
  EXPECT_EQ(sweep.points_lidar, sweepAt(0.1).points_lidar);
  EXPECT_EQ(sweep.times_s, sweepAt(0.1).times_s);

  rosbag::Bag bag(path_);
  double x = -1.0;
  for (const auto& message : rosbag::View(bag, rosbag::TopicQuery("/ground_truth/odometry"))) {
    x = message.instantiate<nav_msgs::Odometry>()->pose.pose.position.x;
  }
  EXPECT_NEAR(x, 2.0, 1e-12);  // from the first sweep's base_link
  for (const auto& message : rosbag::View(bag, rosbag::TopicQuery("/tf_static"))) {
    EXPECT_TRUE(message.isLatching());
    EXPECT_EQ(message.getDataType(), "tf2_msgs/TFMessage");
  }
}

TEST_F(VelodyneBagWriterTest, ArrivalOrderIsKeptWhateverTheStampsSay) {
  VelodyneBagWriter writer(path_, T_base_lidar_);
  for (double stamp_s : {0.1, 0.3, 0.2, -4.6, 0.5}) writer.add(sweepAt(stamp_s), Pose::Identity(), std::abs(stamp_s));
  writer.close();
  rosbag::Bag bag(path_);
  std::vector<double> stamps_s;
  for (const auto& message : rosbag::View(bag, rosbag::TopicQuery("/velodyne_points"))) {
    const double since =
        (message.instantiate<sensor_msgs::PointCloud2>()->header.stamp - ros::Time(1577836800, 0)).toSec();
    stamps_s.push_back(since);
  }
  ASSERT_EQ(stamps_s.size(), 5u);
  EXPECT_NEAR(stamps_s[1], 0.3, 1e-9);
  EXPECT_NEAR(stamps_s[2], 0.2, 1e-9);
  EXPECT_NEAR(stamps_s[3], -4.6, 1e-9);
}

TEST_F(VelodyneBagWriterTest, PlaceThatCannotBeWrittenIsRefused) {
  EXPECT_THROW(VelodyneBagWriter("/no/such/folder/x.bag", T_base_lidar_), InputError);
}

}  // namespace
}  // namespace fail_aware::velodyne_bag_writer_test
