#include "bridge/bag_sweep_source.hpp"

#include <gtest/gtest.h>
#include <std_msgs/Header.h>
#include <tf2_msgs/TFMessage.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "bridge/kitti_bag_writer.hpp"
#include "core/io/input_error.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"

namespace fail_aware::bag_sweep_source_test {
namespace {

namespace fs = std::filesystem;

const ros::Time kStart(1317000000, 0);

Sweep sweepOf(int number) {
  Sweep sweep;
  for (int i = 0; i <= number; ++i) sweep.points_lidar.emplace_back(1.0f + static_cast<float>(i), 2.0f, 3.0f);
  sweep.intensities.assign(sweep.size(), 0.5f);
  return sweep;
}

class BagSweepSourceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = (fs::path(::testing::TempDir()) / ("bag_sweep_source_" + std::to_string(getpid()) + ".bag")).string();
  }
  void TearDown() override { fs::remove(path_); }

  void writeDrive(int sweeps) const {
    KittiBagWriter writer(path_,
                          {poseFromVector((Vector6d() << -0.6, 0.1, 1.7, 0.0, 0.02, 0.1).finished()), false, false});
    for (int i = 0; i < sweeps; ++i) writer.add(kStart + ros::Duration(0.1 * i), sweepOf(i), Pose::Identity());
    writer.close();
  }

  sensor_msgs::PointCloud2 cloud(const std::string& frame) const {
    sensor_msgs::PointCloud2 cloud;
    writeKittiCloud(sweepOf(2), false, cloud);
    cloud.header.frame_id = frame;
    cloud.header.stamp = kStart;
    return cloud;
  }

  void expectRefused(const std::string& topic, const std::string& part) const {
    try {
      BagSweepSource source({path_}, topic);
      ADD_FAILURE() << "not refused; expected: " << part;
    } catch (const InputError& error) {
      const std::string text = error.what();
      EXPECT_EQ(text.rfind(path_, 0), 0u) << text;
      EXPECT_NE(text.find(part), std::string::npos) << text;
      EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    }
  }

  static geometry_msgs::TransformStamped transform(const std::string& parent, const std::string& child, double x_m,
                                                   double yaw_rad = 0.0) {
    geometry_msgs::TransformStamped message;
    message.header.frame_id = parent;
    message.child_frame_id = child;
    message.transform = toTransformMessage(poseFromVector((Vector6d() << x_m, 0.0, 1.5, 0.0, 0.0, yaw_rad).finished()));
    return message;
  }

  /// A cloud of "velodyne", and at each tenth of a second odom -> base_link, which moves, and what `more` gives for it.
  template <class More>
  BagSweepSource::Mounting mountingFromTf(More&& more) const {
    {
      rosbag::Bag bag(path_, rosbag::bagmode::Write);
      bag.write("/points", kStart, cloud("velodyne"));
      for (int i = 0; i < 20; ++i) {
        tf2_msgs::TFMessage message;
        message.transforms = more(i);
        message.transforms.push_back(transform("odom", "base_link", 1.4 * i, 0.1 * i));
        bag.write("/tf", kStart + ros::Duration(0.1 * i), message);
      }
    }
    return BagSweepSource({path_}).lidarInBase("base_link");
  }
  using Transforms = std::vector<geometry_msgs::TransformStamped>;

  std::string path_;
};

TEST_F(BagSweepSourceTest, TakesAConstantPlaceFromTf) {
  const BagSweepSource::Mounting mounting = mountingFromTf([](int i) {
    const double noise = 1e-6 * (i % 3);
    return i < 3 ? Transforms()
                 : Transforms{transform("/mast", "/velodyne", 0.25 + noise), transform("base_link", "mast", -1.0)};
  });
  ASSERT_TRUE(mounting.T_base_lidar) << mounting.why_not;
  EXPECT_NEAR(mounting.T_base_lidar->translation().x(), -0.75, 1e-9) << "the first ones count";
  EXPECT_NEAR(mounting.T_base_lidar->translation().z(), 3.0, 1e-12);
}

TEST_F(BagSweepSourceTest, APlaceThatChangesIsNotKnown) {
  const auto whyNot = [&](auto&& more) {
    const BagSweepSource::Mounting mounting = mountingFromTf(more);
    EXPECT_FALSE(mounting.T_base_lidar);
    return mounting.why_not;
  };
  EXPECT_EQ(
      whyNot([](int i) { return Transforms{transform("base_link", "velodyne", i == 19 ? 1.02 : 1.0)}; }),
      "the transform base_link -> velodyne is not constant: base_link -> velodyne changes by up to 0.02 m and 0 deg");
  EXPECT_NE(whyNot([](int i) {
              return Transforms{transform("base_link", "mast", 1.0, 1e-4 * i), transform("mast", "velodyne", 0.0)};
            }).find("base_link -> mast changes by up to"),
            std::string::npos)
      << "slowly";
  EXPECT_NE(whyNot([](int i) {
              return Transforms{transform("base_link", "mast", 1.0),
                                transform(i < 5 ? "base_link" : "mast", "velodyne", 0.0)};
            }).find("velodyne has two parents, base_link and mast"),
            std::string::npos);
  EXPECT_EQ(whyNot([](int) {
              return Transforms{transform("odom", "velodyne", 1.0)};
            }).find("the transform base_link -> velodyne is not constant"),
            0u)
      << "it does not move with the vehicle";
  EXPECT_EQ(whyNot([](int) {
              return Transforms{transform("velodyne", "mast", 1.0), transform("mast", "velodyne", 1.0)};
            }),
            "/tf_static and /tf do not connect base_link -> velodyne")
      << "a loop";
  EXPECT_EQ(whyNot([](int) { return Transforms{transform("base_link", "velodyne", std::nan(""))}; }),
            "/tf_static and /tf do not connect base_link -> velodyne");
}

TEST_F(BagSweepSourceTest, CloudsWithoutAFrameAreNamed) {
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    bag.write("/points", kStart, cloud(""));
  }
  EXPECT_EQ(BagSweepSource({path_}).lidarInBase("base_link").why_not,
            "the clouds on /points have an empty header.frame_id");
}

TEST_F(BagSweepSourceTest, PartsAreReadInTheOrderOfTheirRecording) {
  const std::string later = path_ + "_0_later.bag", none = path_ + "_none.bag";
  const auto write = [&](const std::string& path, int first, int last) {
    rosbag::Bag bag(path, rosbag::bagmode::Write);
    for (int i = first; i < last; ++i) {
      sensor_msgs::PointCloud2 message;
      writeKittiCloud(sweepOf(i), false, message);
      message.header.frame_id = "velodyne";
      message.header.stamp = kStart + ros::Duration(0.1 * i);
      bag.write("/points", message.header.stamp, message);
    }
    tf2_msgs::TFMessage mounting;
    mounting.transforms = {transform("base_link", "velodyne", 1.25)};
    if (first == 0) bag.write("/tf_static", kStart, mounting);
  };
  write(path_, 0, 3);
  write(later, 3, 8);
  for (const auto& paths : {std::vector<std::string>{path_, later}, {later, path_}}) {
    BagSweepSource source(paths);
    ASSERT_EQ(source.size(), 8u);
    ASSERT_TRUE(source.lidarInBase("base_link").T_base_lidar);
    source.skip(1);
    Sweep sweep;
    for (int i = 1; i < 8; ++i) {
      EXPECT_TRUE(source.next(sweep).hasPoints());
      EXPECT_EQ(sweep.points_lidar, sweepOf(i).points_lidar) << i;
      EXPECT_EQ(source.name(),
                (i < 3 ? path_ + ", cloud " + std::to_string(i) : later + ", cloud " + std::to_string(i - 3)) +
                    " of /points");
    }
  }
  EXPECT_THROW(BagSweepSource(std::vector<std::string>{path_, path_}), InputError);
  {
    rosbag::Bag bag(none, rosbag::bagmode::Write);
    bag.write("/header", kStart, std_msgs::Header());
  }
  EXPECT_THROW(BagSweepSource(std::vector<std::string>{path_, none}), InputError) << "nothing of the drive in it";
  fs::remove(later);
  fs::remove(none);
}

TEST_F(BagSweepSourceTest, RecordingsOfRos2AreNamed) {
  std::ofstream(path_) << "SQLite format 3" << std::string(20, '\0');
  expectRefused("",
                "is a ROS 2 bag (sqlite3), not a ROS 1 bag; convert its folder: pip install rosbags; rosbags-convert");
  std::ofstream(path_) << "\x89MCAP0\r\n";
  expectRefused("", "is an MCAP file (ROS 2 bag), not a ROS 1 bag");
  fs::remove(path_);
  fs::create_directory(path_);
  expectRefused("", "is a folder, not a file; give a folder of KITTI with --kitti");
  std::ofstream(fs::path(path_) / "metadata.yaml") << "rosbag2_bagfile_information:\n";
  expectRefused("", "is a ROS 2 bag, not a ROS 1 bag");
  fs::remove_all(path_);
}

TEST_F(BagSweepSourceTest, GivesTheSweepsInOrder) {
  writeDrive(4);
  BagSweepSource source({path_});
  EXPECT_EQ(source.topic(), "/kitti/velo/pointcloud");
  EXPECT_TRUE(source.lidarInBase("velo_link").T_base_lidar.has_value()) << "the clouds' own frame";
  ASSERT_EQ(source.size(), 4u);
  Sweep sweep;
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(source.next(sweep).status, ReadStatus::kOk);
    EXPECT_EQ(sweep.points_lidar, sweepOf(i).points_lidar);
    EXPECT_EQ(sweep.stamp_s, (kStart + ros::Duration(0.1 * i)).toSec());
    EXPECT_EQ(source.name(), path_ + ", cloud " + std::to_string(i) + " of /kitti/velo/pointcloud");
  }
}

TEST_F(BagSweepSourceTest, Skips) {
  writeDrive(4);
  BagSweepSource source({path_}, "/kitti/velo/pointcloud");
  source.skip(3);
  Sweep sweep;
  EXPECT_TRUE(source.next(sweep).hasPoints());
  EXPECT_EQ(sweep.size(), 4u);
  EXPECT_EQ(source.size(), 4u);
}

TEST_F(BagSweepSourceTest, FindsWhereTheLidarSits) {
  writeDrive(1);
  const BagSweepSource source({path_});
  const std::optional<Pose> T_base_lidar = source.lidarInBase("base_link").T_base_lidar;
  ASSERT_TRUE(T_base_lidar);
  const Vector6d place = vectorFromPose(*T_base_lidar);
  EXPECT_TRUE(place.isApprox((Vector6d() << -0.6, 0.1, 1.7, 0.0, 0.02, 0.1).finished(), 1e-12)) << place.transpose();
  EXPECT_TRUE(source.lidarInBase("/base_link").T_base_lidar) << "old names begin with a slash";
  EXPECT_TRUE(source.lidarInBase("velo_link").T_base_lidar->isApprox(Pose::Identity()));
  EXPECT_FALSE(source.lidarInBase("vehicle").T_base_lidar);
  EXPECT_EQ(source.lidarInBase("vehicle").why_not, "/tf_static and /tf do not connect vehicle -> velo_link");
}

TEST_F(BagSweepSourceTest, TransformsAreChained) {
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    tf2_msgs::TFMessage message;
    message.transforms.resize(2);
    message.transforms[0].header.frame_id = "base_link";
    message.transforms[0].child_frame_id = "imu_link";
    message.transforms[0].transform.translation.x = -1.405;
    message.transforms[1].header.frame_id = "imu_link";
    message.transforms[1].child_frame_id = "velo_link";
    message.transforms[1].transform.translation.x = 0.81;
    for (geometry_msgs::TransformStamped& transform : message.transforms) transform.transform.rotation.w = 1.0;
    bag.write("/points", kStart, cloud("velo_link"));
    bag.write("/tf_static", kStart + ros::Duration(1.0), message);
  }
  const std::optional<Pose> T_base_lidar = BagSweepSource({path_}).lidarInBase("base_link").T_base_lidar;
  ASSERT_TRUE(T_base_lidar);
  EXPECT_NEAR(T_base_lidar->translation().x(), -0.595, 1e-12);
}

TEST_F(BagSweepSourceTest, CloudsThatCannotBeUsedAreData) {
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    sensor_msgs::PointCloud2 bad = cloud("velodyne");
    bag.write("/points", kStart, bad);
    bad.header.frame_id = "radar";
    bag.write("/points", kStart + ros::Duration(0.1), bad);
    bad.header.frame_id = "velodyne";
    bad.header.stamp = kStart + ros::Duration(0.2);
    bad.fields[2].name = "height";
    bag.write("/points", kStart + ros::Duration(0.2), bad);
    bad.fields[2].name = "z";
    bad.width = bad.row_step = 0;
    bag.write("/points", kStart + ros::Duration(0.3), bad);
  }
  BagSweepSource source({path_});
  Sweep sweep;
  EXPECT_EQ(source.next(sweep).status, ReadStatus::kOk);
  ReadResult result = source.next(sweep);
  EXPECT_EQ(result.status, ReadStatus::kOtherFrame);
  EXPECT_NE(result.message.find("cloud 1 of /points: its frame is 'radar'"), std::string::npos) << result.message;
  EXPECT_TRUE(sweep.empty());
  result = source.next(sweep);
  EXPECT_EQ(result.status, ReadStatus::kNoPoints);
  EXPECT_NE(result.message.find("no field z"), std::string::npos) << result.message;
  EXPECT_EQ(sweep.stamp_s, (kStart + ros::Duration(0.2)).toSec());
  EXPECT_EQ(source.next(sweep).status, ReadStatus::kNoPoints);
}

TEST_F(BagSweepSourceTest, RefusesWhatIsNoBagWithClouds) {
  expectRefused("", "no such file");
  std::ofstream(path_).close();
  expectRefused("", "cannot be read, or is empty");
  std::ofstream(path_) << "hello\n";
  expectRefused("", "not a ROS 1 bag");
  { rosbag::Bag bag(path_, rosbag::bagmode::Write); }
  expectRefused("", "the bag has no messages");
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    bag.write("/header", kStart, std_msgs::Header());
  }
  expectRefused("", "no topic of type sensor_msgs/PointCloud2");
  expectRefused("/points", "no topic /points; the bag has no topic of type sensor_msgs/PointCloud2");
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    bag.write("/front", kStart, cloud("a"));
    bag.write("/rear", kStart, cloud("b"));
    bag.write("/header", kStart, std_msgs::Header());
  }
  expectRefused("", "clouds on /front, /rear; name one with --topic");
  expectRefused("/header", "/header is of type std_msgs/Header, not sensor_msgs/PointCloud2");
  expectRefused("/left", "no topic /left; the bag has clouds on /front, /rear");
  EXPECT_TRUE(BagSweepSource({path_}, "/rear").lidarInBase("b").T_base_lidar.has_value());
}

TEST_F(BagSweepSourceTest, RefusesARecordingThatWasCutOff) {
  writeDrive(20);
  const auto size = fs::file_size(path_);
  for (const double share : {0.01, 0.5, 0.9, 0.999}) {
    writeDrive(20);
    fs::resize_file(path_, static_cast<std::uintmax_t>(share * static_cast<double>(size)));
    expectRefused("", "rosbag reindex");
  }
}

}  // namespace
}  // namespace fail_aware::bag_sweep_source_test
