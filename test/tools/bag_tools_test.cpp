// kitti_to_bag, and offline_odometry over the bag it makes; KITTI_TO_BAG and OFFLINE_ODOMETRY are
// the tools' paths.
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/PointCloud2.h>

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "../support/synthetic_street.hpp"
#include "../support/tool_run.hpp"
#include "core/io/trajectory_io.hpp"

namespace fail_aware::bag_tools_test {
namespace {

namespace fs = std::filesystem;

constexpr int kScansOfTheBag = 8;

std::string numbered(const char* format, int number) {
  char name[32];
  std::snprintf(name, sizeof(name), format, number);
  return name;
}

template <class T>
void writeArray(const fs::path& path, const std::vector<T>& values) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
}

class BagTools : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) / ("bag_tools_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// With KITTI's kind of stamps (six decimals, no even period), and the time of every point.
  std::string makeDrive(bool with_point_times) const {
    const fs::path drive = folder_ / "drive";
    fs::create_directories(drive / "velodyne");
    fs::create_directories(drive / "stamps");
    fs::create_directories(drive / "rings");
    const synthetic::Street street;
    const synthetic::Drive motion;
    synthetic::Lidar lidar;
    lidar.columns = 150;
    std::ofstream times(drive / "times.txt");
    std::vector<Pose> truth;
    for (int i = 0; i < kScansOfTheBag; ++i) {
      const double stamp_s = 0.103288 * i + 1e-6 * (i % 3);
      times << std::to_string(stamp_s) << "\n";  // six decimals
      const Sweep sweep =
          street.scan([&](double t) { return motion.T_street_base(t); }, stamp_s, static_cast<std::uint32_t>(i), lidar);
      std::vector<std::array<float, 4>> points;
      std::vector<float> point_times;
      for (const Eigen::Vector3f& p : sweep.points_lidar) {
        points.push_back({p.x(), p.y(), p.z(), 0.5f});
        point_times.push_back(static_cast<float>(0.05 * (1.0 - std::atan2(p.y(), p.x()) / M_PI)));
      }
      writeArray(drive / "velodyne" / numbered("%06d.bin", i), points);
      writeArray(drive / "rings" / numbered("%06d.u16", i), sweep.rings);
      if (with_point_times) writeArray(drive / "stamps" / numbered("%06d.f32", i), point_times);
      truth.push_back(lidar.T_base_lidar.inverse() * motion.T_odom_base(stamp_s) * lidar.T_base_lidar);
    }
    if (!with_point_times) fs::remove_all(drive / "stamps");
    writeKittiTrajectory((drive / "poses.txt").string(), truth);
    return drive.string();
  }

  std::string bag() const { return (folder_ / "drive.bag").string(); }
  ToolRun toBag(const std::string& arguments) const { return runProgram(KITTI_TO_BAG, arguments, folder_); }
  ToolRun offline(const std::string& arguments, const std::string& output) const {
    return runProgram(OFFLINE_ODOMETRY,
                      arguments + " --output '" + (folder_ / output).string() +
                          "' --set registration.initialization.max_speed_mps=25"
                          " --set registration.initialization.max_yaw_rate_rps=0.2",
                      folder_);
  }
  std::string trajectory(const std::string& output) const {
    return contentOf(folder_ / output / "trajectory_kitti.txt");
  }

  void expectRefused(const ToolRun& run, const std::string& tool, const std::string& part) const {
    EXPECT_EQ(run.exit_code, 2) << part;
    expectOneErrorLine(run, tool, part);
  }

  fs::path folder_;
};

// Byte for byte: the points are the same floats, the stamps differ by a constant, the lidar sits where the sensor file
// says.
TEST_F(BagTools, TheBagGivesTheFoldersTrajectory) {
  const std::string drive = makeDrive(false);
  const ToolRun made = toBag("'" + drive + "' '" + bag() + "'");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_NE(made.out.find("8 sweeps (0 without points)"), std::string::npos) << made.out;
  ASSERT_EQ(offline("--kitti '" + drive + "'", "folder").exit_code, 0);
  const ToolRun run = offline("--bag '" + bag() + "'", "bag");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err.find(" warning: "), std::string::npos) << run.err;
  ASSERT_FALSE(trajectory("folder").empty());
  EXPECT_TRUE(trajectory("bag") == trajectory("folder"));
  const std::vector<Pose> lidar = readKittiTrajectory((folder_ / "bag" / "trajectory_kitti.txt").string());
  ASSERT_EQ(lidar.size(), static_cast<std::size_t>(kScansOfTheBag));
  const std::vector<Pose> truth = readKittiTrajectory(drive + "/poses.txt");
  EXPECT_LT((lidar.back().translation() - truth.back().translation()).norm(), 0.1);
}

TEST_F(BagTools, PointTimesPassThroughTheBag) {
  const std::string drive = makeDrive(true);
  ASSERT_EQ(toBag("'" + drive + "' '" + bag() + "' --point-times").exit_code, 0);
  ASSERT_EQ(offline("--kitti '" + drive + "' --set sensor.timing.source=field", "folder").exit_code, 0);
  ASSERT_EQ(offline("--bag '" + bag() + "' --set sensor.timing.source=field", "bag").exit_code, 0);
  ASSERT_FALSE(trajectory("folder").empty());
  EXPECT_TRUE(trajectory("bag") == trajectory("folder"));
}

TEST_F(BagTools, AReferenceThatThePointTimesContradictIsWarnedOf) {
  const std::string drive = makeDrive(true), other = (folder_ / "other.bag").string();
  ASSERT_EQ(toBag("'" + drive + "' '" + bag() + "' --point-times").exit_code, 0);
  EXPECT_EQ(offline("--bag '" + bag() + "'", "kitti").err.find(" warning: "), std::string::npos)
      << "what KITTI's stamps mean is known";
  {
    const rosbag::Bag from(bag());
    rosbag::Bag to(other, rosbag::bagmode::Write);
    for (const rosbag::MessageInstance& message : rosbag::View(from)) {
      const bool is_cloud = message.isType<sensor_msgs::PointCloud2>();
      to.write(is_cloud ? "/points" : message.getTopic(), message.getTime(), message);
    }
  }
  const ToolRun wrong = offline("--bag '" + other + "' --set sensor.timing.stamp_reference=end", "wrong");
  EXPECT_EQ(wrong.exit_code, 0) << wrong.err;
  EXPECT_NE(wrong.err.find("the points' times say that the stamp is the sweep's start, and "
                           "sensor.timing.stamp_reference says end"),
            std::string::npos)
      << wrong.err;
  EXPECT_EQ(offline("--bag '" + other + "'", "right").err.find(" warning: "), std::string::npos);
}

TEST_F(BagTools, BadScansAndPartsOfTheDriveAreTheFolders) {
  const std::string drive = makeDrive(false);
  fs::resize_file(fs::path(drive) / "velodyne" / "000004.bin", 0);
  const ToolRun made = toBag("'" + drive + "' '" + bag() + "'");
  EXPECT_EQ(made.exit_code, 0) << made.err;
  EXPECT_NE(made.err.find("000004.bin: empty file; written as a cloud without points"), std::string::npos) << made.err;
  EXPECT_EQ(made.err.find("more such scans"), std::string::npos) << made.err;
  ASSERT_EQ(offline("--kitti '" + drive + "' --first 1 --count 6", "folder").exit_code, 0);
  const ToolRun run = offline("--bag '" + bag() + "' --first 1 --count 6", "bag");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(nlohmann::json::parse(run.out)["dropped"], 1);
  EXPECT_NE(run.err.find("cloud 4 of /kitti/velo/pointcloud"), std::string::npos) << run.err;
  ASSERT_FALSE(trajectory("folder").empty());
  EXPECT_TRUE(trajectory("bag") == trajectory("folder"));
}

TEST_F(BagTools, WhereTheLidarSitsIsTakenFromTheBagOrSaid) {
  const std::string drive = makeDrive(false);
  ASSERT_EQ(toBag("'" + drive + "' '" + bag() + "' --count 2").exit_code, 0);
  ASSERT_EQ(offline("--bag '" + bag() + "'", "tf").exit_code, 0);
  EXPECT_NE(contentOf(folder_ / "tf" / "parameters.yaml").find("lidar_in_base: [-0.595, 0.0, 1.73, "),
            std::string::npos);
  const std::string other = "--bag '" + bag() + "' --base-frame rear_axle ";
  expectRefused(offline(other, "none"), "offline_odometry",
                "do not connect rear_axle -> velo_link; give the lidar's place");
  EXPECT_FALSE(fs::exists(folder_ / "none"));
  std::ofstream(folder_ / "mounting.yaml") << "sensor:\n  lidar_in_base: [-1.5, 0.0, 1.5, 0.0, 0.0, 0.0]\n";
  for (const std::string& given : {std::string("--lidar-in-base -1.5,0,1.5,0,0,0"),
                                   "--parameters '" + (folder_ / "mounting.yaml").string() + "'"}) {
    const ToolRun run = offline(other + given, "given");
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_NE(contentOf(folder_ / "given" / "parameters.yaml").find("lidar_in_base: [-1.5, 0.0, 1.5, "),
              std::string::npos);
  }
}

/// Two bags of a drive, in whichever order, give the trajectory of the whole.
TEST_F(BagTools, PartsOfADriveAreOne) {
  const std::string drive = makeDrive(false), later = (folder_ / "a_later.bag").string();
  ASSERT_EQ(toBag("'" + drive + "' '" + bag() + "'").exit_code, 0);
  ASSERT_EQ(offline("--bag '" + bag() + "'", "whole").exit_code, 0);
  ASSERT_EQ(toBag("'" + drive + "' '" + bag() + "' --count 3").exit_code, 0);
  ASSERT_EQ(toBag("'" + drive + "' '" + later + "' --first 3 --start 1317000000").exit_code, 0);
  const ToolRun run = offline("--bag '" + later + "' --bag '" + bag() + "'", "parts");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(nlohmann::json::parse(run.out)["sweeps"], kScansOfTheBag);
  ASSERT_FALSE(trajectory("whole").empty());
  EXPECT_TRUE(trajectory("parts") == trajectory("whole"));
}

/// Clouds of a second lidar on the topic, each just before the first lidar's of the same stamp.
TEST_F(BagTools, AnotherLidarsCloudsAreLeftOut) {
  const std::string drive = makeDrive(false), both = (folder_ / "both.bag").string();
  ASSERT_EQ(toBag("'" + drive + "' '" + bag() + "'").exit_code, 0);
  ASSERT_EQ(offline("--bag '" + bag() + "'", "one").exit_code, 0);
  {
    const rosbag::Bag from(bag());
    rosbag::Bag to(both, rosbag::bagmode::Write);
    int clouds = 0;
    for (const rosbag::MessageInstance& message : rosbag::View(from)) {
      const sensor_msgs::PointCloud2ConstPtr cloud = message.instantiate<sensor_msgs::PointCloud2>();
      if (cloud && clouds++ > 0) {
        sensor_msgs::PointCloud2 other = *cloud;
        other.header.frame_id = "other_lidar";
        to.write(message.getTopic(), message.getTime() - ros::Duration(0.01), other);
      }
      to.write(message.getTopic(), message.getTime(), message);
    }
  }
  const ToolRun run = offline("--bag '" + both + "'", "both");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("its frame is 'other_lidar'"), std::string::npos) << run.err;
  ASSERT_FALSE(trajectory("one").empty());
  EXPECT_TRUE(trajectory("both") == trajectory("one"));
}

TEST_F(BagTools, KittiToBagRefusesInOneLine) {
  const std::string drive = makeDrive(false), both = "'" + drive + "' '" + bag() + "' ";
  expectRefused(toBag("'" + drive + "'"), "kitti_to_bag", "bag is required");
  expectRefused(toBag("/no/such/drive '" + bag() + "'"), "kitti_to_bag", "/no/such/drive: no such directory");
  expectRefused(toBag("'" + drive + "' /no/such/folder/x.bag"), "kitti_to_bag", "cannot write /no/such/folder/x.bag");
  expectRefused(toBag(both + "--point-times"), "kitti_to_bag", "has no folder stamps/");
  expectRefused(toBag(both + "--period 0"), "kitti_to_bag", "--period");
  expectRefused(toBag(both + "--start 1e11"), "kitti_to_bag", "--start");
  expectRefused(toBag(both + "--first 8"), "kitti_to_bag", "--first 8");
  expectRefused(toBag(both + "--sensor vlp"), "kitti_to_bag", "vlp");
  std::ofstream(fs::path(drive) / "poses.txt", std::ios::app) << "1 0 0 0 0 1 0 0 0 0 1 0\n";
  expectRefused(toBag(both), "kitti_to_bag", "9 rows for 8 scans");
  fs::remove(fs::path(drive) / "poses.txt");
  expectRefused(toBag(both + "--with-tf"), "kitti_to_bag", "has no poses.txt");
  EXPECT_FALSE(fs::exists(bag()));
}

TEST_F(BagTools, OfflineRefusesABagInOneLine) {
  const std::string drive = makeDrive(false);
  ASSERT_EQ(toBag("'" + drive + "' '" + bag() + "' --count 4 --with-tf").exit_code, 0);
  const std::string option = "--bag '" + bag() + "' ";
  expectRefused(offline("", "o"), "offline_odometry", "--kitti or --bag");
  expectRefused(offline(option + "--kitti '" + drive + "'", "o"), "offline_odometry", "--kitti");
  expectRefused(offline("--kitti '" + drive + "' --topic /x", "o"), "offline_odometry", "--topic");
  expectRefused(offline(option + "--topic /points", "o"), "offline_odometry", "no topic /points");
  expectRefused(offline(option + "--topic /tf", "o"), "offline_odometry", "/tf is of type tf2_msgs/TFMessage");
  expectRefused(offline("--bag /no/such.bag", "o"), "offline_odometry", "/no/such.bag: no such file");
  expectRefused(offline("--kitti '" + bag() + "'", "o"), "offline_odometry",
                "is a bag, not a folder: give it with --bag");
  expectRefused(offline("--bag '" + drive + "'", "o"), "offline_odometry", "give a folder of KITTI with --kitti");
  fs::resize_file(bag(), fs::file_size(bag()) / 2);
  expectRefused(offline(option, "o"), "offline_odometry", "rosbag reindex");
  EXPECT_FALSE(fs::exists(folder_ / "o"));
}

}  // namespace
}  // namespace fail_aware::bag_tools_test
