#include "core/io/kitti_writer.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "../../support/tum_trajectory.hpp"
#include "core/io/input_error.hpp"
#include "core/io/kitti_directory.hpp"

namespace fail_aware::kitti_writer_test {
namespace {

namespace fs = std::filesystem;

class KittiWriterTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("kitti_writer_test_" + std::to_string(getpid()));
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path folder_;
};

Sweep sweepAt(double stamp_s) {
  Sweep sweep;
  sweep.stamp_s = stamp_s;
  sweep.points_lidar = {{1, 2, 3}, {-4, 5.5f, 6}};
  sweep.intensities = {0.25f, 0.5f};
  sweep.times_s = {0.01f, 0.09f};
  sweep.rings = {3, 63};
  return sweep;
}

TEST_F(KittiWriterTest, WhatIsWrittenIsReadBack) {
  KittiWriter writer(folder_.string());
  std::vector<Pose> truth;
  for (int i = 0; i < 3; ++i) {
    Pose T = Pose::Identity();
    T.translation() << 7.0 + i, 2.0, 0.1 * i;
    truth.push_back(T);
    writer.add(sweepAt(0.05 + 0.1 * i), T, T, 0.05 + 0.1 * i);
  }
  writer.finish();
  const KittiDirectory directory = KittiDirectory::open(folder_.string());
  ASSERT_EQ(directory.size(), 3u);
  EXPECT_NEAR(directory.stamps()[2], 0.25, 1e-9);
  Sweep sweep;
  ASSERT_EQ(directory.read(1, sweep).status, ReadStatus::kOk);
  const Sweep expected = sweepAt(0.15);
  EXPECT_EQ(sweep.points_lidar, expected.points_lidar);
  EXPECT_EQ(sweep.intensities, expected.intensities);
  EXPECT_EQ(sweep.times_s, expected.times_s);
  EXPECT_EQ(sweep.rings, expected.rings);
  const auto poses = readKittiTrajectory((folder_ / "poses.txt").string());
  ASSERT_EQ(poses.size(), 3u);
  EXPECT_TRUE(poses[0].isApprox(Pose::Identity()));
  EXPECT_TRUE(poses[2].isApprox(truth[0].inverse() * truth[2]));
  EXPECT_EQ(readTumTrajectory((folder_ / "ground_truth_tum.txt").string()).size(), 3u);
  EXPECT_TRUE(readLidarToCamera((folder_ / "calib.txt").string()).isApprox(Pose::Identity()));
}

TEST_F(KittiWriterTest, EmptySweepsAndSweepsWithoutTimes) {
  KittiWriter writer(folder_.string());
  Sweep sweep = sweepAt(0.0);
  sweep.times_s.clear();
  writer.add(sweep, Pose::Identity(), Pose::Identity(), 0.0);
  sweep = Sweep();
  sweep.stamp_s = 0.1;
  writer.add(sweep, Pose::Identity(), Pose::Identity(), 0.1);
  writer.finish();
  const KittiDirectory directory = KittiDirectory::open(folder_.string());
  EXPECT_FALSE(directory.hasPointTimes());
  EXPECT_EQ(directory.read(0, sweep).status, ReadStatus::kOk);
  EXPECT_EQ(directory.read(1, sweep).status, ReadStatus::kNoPoints);
}

TEST_F(KittiWriterTest, SweepsWithoutRings) {
  KittiWriter writer(folder_.string());
  Sweep sweep = sweepAt(0.0);
  sweep.rings.clear();
  writer.add(sweep, Pose::Identity(), Pose::Identity(), 0.0);
  writer.finish();
  EXPECT_FALSE(fs::exists(folder_ / "rings"));
  ASSERT_EQ(KittiDirectory::open(folder_.string()).read(0, sweep).status, ReadStatus::kOk);
  EXPECT_TRUE(sweep.rings.empty());
}

TEST_F(KittiWriterTest, WhatIsNotFinishedIsNotRead) {
  KittiWriter writer(folder_.string());
  writer.add(sweepAt(0.0), Pose::Identity(), Pose::Identity(), 0.0);
  EXPECT_THROW(KittiDirectory::open(folder_.string()), InputError) << "without times.txt its stamps would be wrong";
  writer.finish();
  EXPECT_EQ(KittiDirectory::open(folder_.string()).size(), 1u);
}

TEST_F(KittiWriterTest, RefusesAFolderWithScans) {
  KittiWriter first(folder_.string());
  first.add(sweepAt(0.0), Pose::Identity(), Pose::Identity(), 0.0);
  EXPECT_THROW(KittiWriter(folder_.string()), InputError);
  EXPECT_THROW(KittiWriter("/proc/no_such_place"), InputError);
}

}  // namespace
}  // namespace fail_aware::kitti_writer_test
