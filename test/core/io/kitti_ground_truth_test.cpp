#include "core/io/kitti_ground_truth.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "core/io/input_error.hpp"

namespace fail_aware::kitti_ground_truth_test {
namespace {

namespace fs = std::filesystem;

const char* kForward = "1 0 0 2 0 1 0 0 0 0 1 0\n";  // 2 m along the first axis
const char* kIdentity = "1 0 0 0 0 1 0 0 0 0 1 0\n";
// camera x = -lidar y, y = -lidar z, z = lidar x
const char* kCalib = "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n";

class KittiGroundTruthTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) / ("kitti_ground_truth_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const char* name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  KittiGroundTruth read(std::size_t scans = 2) const { return readKittiGroundTruth(folder_.string(), scans); }

  fs::path folder_;
};

TEST_F(KittiGroundTruthTest, IsEmptyWhereThereIsNone) {
  EXPECT_TRUE(read().source.empty());
  EXPECT_TRUE(read().poses.empty());
}

TEST_F(KittiGroundTruthTest, PosesWithCalibrationAreTheCameras) {
  write("poses.txt", std::string(kIdentity) + kForward);
  EXPECT_TRUE(read().poses[1].translation().isApprox(Eigen::Vector3d(2, 0, 0))) << "alone: the lidar's";
  write("calib.txt", kCalib);
  EXPECT_TRUE(read().poses[1].translation().isApprox(Eigen::Vector3d(0, -2, 0))) << "the camera's x is to the right";
}

TEST_F(KittiGroundTruthTest, TheLidarsOwnFileComesFirst) {
  write("poses.txt", std::string(kIdentity) + kIdentity);
  write("calib.txt", kCalib);
  write("poses_velodyne.txt", std::string(kIdentity) + kForward);
  EXPECT_EQ(read().source, (folder_ / "poses_velodyne.txt").string());
  EXPECT_TRUE(read().poses[1].translation().isApprox(Eigen::Vector3d(2, 0, 0)));
}

TEST_F(KittiGroundTruthTest, RefusesAnotherCountOfRows) {
  write("poses.txt", kIdentity);
  try {
    read(2);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()), (folder_ / "poses.txt").string() + ": 1 rows for 2 scans");
  }
}

}  // namespace
}  // namespace fail_aware::kitti_ground_truth_test
