#include "bridge/kitti_bag_writer.hpp"

#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <rosbag/view.h>
#include <tf2_msgs/TFMessage.h>
#include <unistd.h>

#include <filesystem>
#include <map>

#include "core/io/input_error.hpp"
#include "core/types/corrected_sweep.hpp"
#include "fail_aware_lidar_odometry/bridge/point_cloud_conversion.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"

namespace fail_aware::kitti_bag_writer_test {
namespace {

namespace fs = std::filesystem;

const ros::Time kStamp(1317000000, 103288000);
const Pose kLidar = poseFromVector((Vector6d() << -0.595, 0.0, 1.73, 0.0, 0.0, 0.0).finished());

Sweep threePoints() {
  Sweep sweep;
  sweep.points_lidar = {{1, 2, 3}, {4, 5, 6}, {-7, 8, 9}};
  sweep.intensities = {0.1f, 0.2f, 0.3f};
  sweep.times_s = {0.0f, 0.05f, 0.0999f};
  return sweep;
}

std::vector<std::string> namesOf(const sensor_msgs::PointCloud2& cloud) {
  std::vector<std::string> names;
  for (const sensor_msgs::PointField& field : cloud.fields) names.push_back(field.name);
  return names;
}

class KittiBagWriterTest : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = (fs::path(::testing::TempDir()) / ("kitti_bag_writer_" + std::to_string(getpid()) + ".bag")).string();
  }
  void TearDown() override { fs::remove(path_); }

  template <class Message>
  std::vector<typename Message::ConstPtr> messages(const std::string& topic) const {
    rosbag::Bag bag(path_);
    std::vector<typename Message::ConstPtr> found;
    for (const rosbag::MessageInstance& instance : rosbag::View(bag, rosbag::TopicQuery(topic))) {
      found.push_back(instance.instantiate<Message>());
    }
    return found;
  }

  std::string path_;
};

TEST(WriteKittiCloud, HasTheFieldsOfKitti2bag) {
  sensor_msgs::PointCloud2 cloud;
  writeKittiCloud(threePoints(), false, cloud);
  EXPECT_EQ(namesOf(cloud), (std::vector<std::string>{"x", "y", "z", "i"}));
  EXPECT_EQ(cloud.point_step, 16u);
  EXPECT_EQ(cloud.row_step, 48u);
  EXPECT_EQ(cloud.height, 1u);
  EXPECT_EQ(cloud.width, 3u);
  for (const sensor_msgs::PointField& field : cloud.fields) {
    EXPECT_EQ(field.datatype, sensor_msgs::PointField::FLOAT32);
    EXPECT_EQ(field.count, 1u);
  }
  Sweep back;
  ASSERT_TRUE(readCloud(cloud, back).ok());
  EXPECT_EQ(back.points_lidar, threePoints().points_lidar);
  EXPECT_EQ(back.intensities, threePoints().intensities);
  EXPECT_TRUE(back.times_s.empty());
}

TEST(WriteKittiCloud, HasTimesWhereAskedForAndThere) {
  sensor_msgs::PointCloud2 cloud;
  writeKittiCloud(threePoints(), true, cloud);
  EXPECT_EQ(namesOf(cloud).back(), "time");
  Sweep back;
  ASSERT_TRUE(readCloud(cloud, back).ok());
  EXPECT_EQ(back.times_s, threePoints().times_s);

  Sweep without = threePoints();
  without.times_s.pop_back();
  writeKittiCloud(without, true, cloud);
  EXPECT_EQ(namesOf(cloud).back(), "i");
}

TEST(WriteKittiCloud, ASweepWithoutPointsIsAnEmptyCloud) {
  sensor_msgs::PointCloud2 cloud;
  writeKittiCloud(Sweep(), true, cloud);
  EXPECT_EQ(cloud.width, 0u);
  EXPECT_TRUE(cloud.data.empty());
  Sweep back;
  EXPECT_EQ(readCloud(cloud, back).status, CloudStatus::kEmpty);
}

TEST_F(KittiBagWriterTest, WritesCloudTransformAndTruth) {
  const Pose T_world_base = poseFromVector((Vector6d() << 10, -2, 0.5, 0.01, -0.02, 3.0).finished());
  {
    KittiBagWriter writer(path_, {kLidar, false, true});
    writer.add(kStamp, threePoints(), T_world_base);
    writer.add(kStamp + ros::Duration(0.1), threePoints());
    writer.close();
  }
  const auto clouds = messages<sensor_msgs::PointCloud2>("/kitti/velo/pointcloud");
  ASSERT_EQ(clouds.size(), 2u);
  EXPECT_EQ(clouds[0]->header.frame_id, "velo_link");
  EXPECT_EQ(clouds[0]->header.stamp, kStamp);

  const auto statics = messages<tf2_msgs::TFMessage>("/tf_static");
  ASSERT_EQ(statics.size(), 3u) << "once ahead, once with every sweep";
  for (const auto& message : statics) {
    ASSERT_EQ(message->transforms.size(), 1u);
    EXPECT_EQ(message->transforms[0].header.frame_id, "base_link");
    EXPECT_EQ(message->transforms[0].child_frame_id, "velo_link");
    EXPECT_TRUE(fromMessage(message->transforms[0].transform)->matrix() == kLidar.matrix());
  }
  const auto moving = messages<tf2_msgs::TFMessage>("/tf");
  ASSERT_EQ(moving.size(), 1u);
  EXPECT_EQ(moving[0]->transforms[0].header.frame_id, "world");
  EXPECT_EQ(moving[0]->transforms[0].child_frame_id, "base_link");
  EXPECT_TRUE(fromMessage(moving[0]->transforms[0].transform)->isApprox(T_world_base, 1e-12));
  const auto truth = messages<nav_msgs::Odometry>("/kitti/ground_truth");
  ASSERT_EQ(truth.size(), 1u);
  EXPECT_EQ(truth[0]->header.frame_id, "world");
  EXPECT_EQ(truth[0]->child_frame_id, "base_link");
  EXPECT_TRUE(fromMessage(truth[0]->pose.pose)->isApprox(T_world_base, 1e-12));
}

TEST_F(KittiBagWriterTest, TransformComesBeforeTheFirstCloud) {
  {
    KittiBagWriter writer(path_, {kLidar, false, false});
    writer.add(kStamp, threePoints());
  }
  rosbag::Bag bag(path_);
  rosbag::View view(bag);
  EXPECT_EQ(view.begin()->getTopic(), "/tf_static");
  EXPECT_EQ(view.getBeginTime(), kStamp - ros::Duration(0.5));
  EXPECT_TRUE(view.begin()->isLatching());
}

TEST_F(KittiBagWriterTest, BaseLinkHasNoSecondParentUnlessAskedFor) {
  {
    KittiBagWriter writer(path_, {kLidar, false, false});
    writer.add(kStamp, threePoints(), Pose::Identity());
  }
  EXPECT_TRUE(messages<tf2_msgs::TFMessage>("/tf").empty());
  EXPECT_EQ(messages<nav_msgs::Odometry>("/kitti/ground_truth").size(), 1u);
}

TEST(KittiBagWriter, SaysWhatCannotBeWritten) {
  EXPECT_THROW(KittiBagWriter("/no/such/folder/x.bag", {}), InputError);
  EXPECT_THROW(KittiBagWriter(::testing::TempDir(), {}), InputError) << "a folder";
}

}  // namespace
}  // namespace fail_aware::kitti_bag_writer_test
