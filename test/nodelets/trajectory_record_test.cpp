#include "../../src/nodelets/trajectory_record.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "../support/tum_trajectory.hpp"
#include "core/io/input_error.hpp"

namespace fail_aware::trajectory_record_test {
namespace {

Pose ahead(double x_m) { return Pose(Eigen::Translation3d(x_m, 0.0, 0.0)); }

TEST(TrajectoryRecord, WritesWhatItKeepsAndTheOldestGiveWay) {
  TrajectoryRecord record(3);
  for (int i = 0; i < 5; ++i) record.add(100.0 + i, ahead(i));
  EXPECT_EQ(record.size(), 3u);
  EXPECT_EQ(record.forgotten(), 2u);
  const std::string path = (std::filesystem::temp_directory_path() / "trajectory_record_test.txt").string();
  record.save(path);
  const std::vector<StampedPose> poses = readTumTrajectory(path);
  std::filesystem::remove(path);
  ASSERT_EQ(poses.size(), 3u);
  EXPECT_NEAR(poses.front().stamp_s, 102.0, 1e-6);
  EXPECT_NEAR(poses.back().T.translation().x(), 4.0, 1e-6);
  EXPECT_THROW(record.save("/no/such/folder/trajectory.txt"), InputError);
  record.clear();
  EXPECT_EQ(record.size(), 0u);
  EXPECT_EQ(record.forgotten(), 0u);
}

}  // namespace
}  // namespace fail_aware::trajectory_record_test
