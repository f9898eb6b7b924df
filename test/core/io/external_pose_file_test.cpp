#include "core/io/external_pose_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>

#include "core/io/input_error.hpp"

namespace fail_aware::external_pose_file_test {
namespace {

const std::string kHeader = "stamp,x,y,z,qx,qy,qz,qw,sigma_x,sigma_y,sigma_z,sigma_roll,sigma_pitch,sigma_yaw\n";

class ExternalPoseFile : public testing::Test {
 protected:
  std::vector<ExternalPose> read(const std::string& text) {
    std::ofstream(path_) << text;
    return readExternalPoses(path_);
  }
  std::string fault(const std::string& text) {
    try {
      read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  void TearDown() override { std::remove(path_.c_str()); }

  std::string path_ = testing::TempDir() + "poses_" + std::to_string(getpid()) + ".csv";
};

TEST_F(ExternalPoseFile, RowsArePosesInTheOrderOfTheirStamps) {
  const auto poses = read(kHeader + "12.5,1,2,3,0,0,1,0,0.1,0.2,0.3,0,0,0\n11,4,5,6,0,0,0,1,1,1,1,0.01,0.01,0.02\n");
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[0].stamp_s, 11.0);
  EXPECT_NEAR(poses[0].covariance(5, 5), 4e-4, 1e-12);
  EXPECT_EQ(poses[1].T_odom_base.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(poses[1].T_odom_base.linear()(0, 0), -1.0, 1e-12) << "half a turn";
  EXPECT_NEAR(poses[1].covariance(1, 1), 0.04, 1e-12);
}

TEST_F(ExternalPoseFile, FaultsAreNamed) {
  EXPECT_NE(fault("stamp,x\n1,2\n").find("sigma_yaw"), std::string::npos) << "says which columns it needs";
  EXPECT_NE(fault(kHeader + "1,2,3\n").find(":2:"), std::string::npos);
  EXPECT_NE(fault(kHeader + "1,0,0,0,0,0,0,2,1,1,1,1,1,1\n").find("quaternion"), std::string::npos);
  EXPECT_NE(fault(kHeader + "1,0,0,0,0,0,0,1,-1,1,1,1,1,1\n").find("negative"), std::string::npos);
}

}  // namespace
}  // namespace fail_aware::external_pose_file_test
