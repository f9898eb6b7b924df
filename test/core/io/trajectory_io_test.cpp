#include "core/io/trajectory_io.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "../../support/tum_trajectory.hpp"
#include "core/geometry/rotation.hpp"
#include "core/io/input_error.hpp"

namespace fail_aware::trajectory_io_test {
namespace {

constexpr char kIdentityRow[] = "1 0 0 0 0 1 0 0 0 0 1 0";

class TrajectoryIo : public ::testing::Test {
 protected:
  void TearDown() override { std::remove(path_.c_str()); }

  const std::string& file(const std::string& content) {
    std::ofstream(path_) << content;
    return path_;
  }

  std::string path_ = ::testing::TempDir() + "fail_aware_trajectory_" +
                      ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".txt";
};

template <class Read>
std::string errorOf(Read&& read) {
  try {
    read();
  } catch (const InputError& error) {
    return error.what();
  }
  return "(no InputError)";
}

std::vector<Pose> somePoses() {
  std::vector<Pose> poses;
  for (int i = 0; i < 5; ++i) {
    Vector6d v;
    v << 1234.5678 * i, -0.001 * i, 2.5, 0.01 * i, -0.02 * i, 0.8 * i;
    poses.push_back(poseFromVector(v));
  }
  return poses;
}

TEST_F(TrajectoryIo, KittiRowIsTheUpperMatrixRowByRow) {
  const std::vector<Pose> poses = readKittiTrajectory(file("0 -1 0 4 1 0 0 5 0 0 1 6\n"));
  ASSERT_EQ(poses.size(), 1u);
  EXPECT_TRUE(poses[0].translation().isApprox(Eigen::Vector3d(4, 5, 6)));
  EXPECT_NEAR(rpyFromRotation(poses[0].linear()).z(), M_PI / 2, 1e-12);
}

TEST_F(TrajectoryIo, KittiSurvivesWritingAndReading) {
  const std::vector<Pose> poses = somePoses();
  writeKittiTrajectory(path_, poses);
  const std::vector<Pose> again = readKittiTrajectory(path_);
  ASSERT_EQ(again.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) EXPECT_TRUE(again[i].isApprox(poses[i], 1e-10)) << i;
}

TEST_F(TrajectoryIo, TumSurvivesWritingAndReading) {
  std::vector<StampedPose> poses;
  for (const Pose& T : somePoses()) poses.push_back({1317012345.123456 + 0.1 * static_cast<double>(poses.size()), T});
  writeTumTrajectory(path_, poses);
  const std::vector<StampedPose> again = readTumTrajectory(path_);
  ASSERT_EQ(again.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_NEAR(again[i].stamp_s, poses[i].stamp_s, 1e-6);
    EXPECT_TRUE(again[i].T.isApprox(poses[i].T, 1e-10)) << i;
  }
}

TEST_F(TrajectoryIo, TumOrderEndsWithTheRealPart) {
  writeTumTrajectory(
      path_, {{12.5, Pose(Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()))}});
  std::ifstream written(path_);
  std::string comment;
  std::getline(written, comment);
  EXPECT_EQ(comment, "# stamp x y z qx qy qz qw");
  const double half = std::sqrt(0.5);
  for (const double expected : {12.5, 1.0, 2.0, 3.0, 0.0, 0.0, half, half}) {
    double number = -1.0;
    written >> number;
    EXPECT_NEAR(number, expected, 1e-9);
  }
}

TEST_F(TrajectoryIo, WindowsLineEndsAndEmptyLinesAtTheEndAreFine) {
  EXPECT_EQ(readKittiTrajectory(file(std::string(kIdentityRow) + "\r\n" + kIdentityRow + "\r\n\r\n\n")).size(), 2u);
}

TEST_F(TrajectoryIo, AByteOrderMarkIsNoPartOfTheFirstNumber) {
  const std::string mark = "\xEF\xBB\xBF";
  EXPECT_EQ(readKittiTrajectory(file(mark + kIdentityRow + "\r\n" + kIdentityRow + "\r\n")).size(), 2u);
  EXPECT_EQ(readTimes(file(mark + "0.5\r\n0.6\r\n")).front(), 0.5);
  EXPECT_TRUE(readLidarToCamera(file(mark + "Tr: 1 0 0 7 0 1 0 0 0 0 1 0\r\n"))
                  .translation()
                  .isApprox(Eigen::Vector3d(7, 0, 0)));
  EXPECT_EQ(errorOf([&] { readTimes(file(std::string("\xFF\xFE") + "0\0.\0" + "5\0")); }),
            path_ + ": is not text, or is text in UTF-16; save it as UTF-8");
  EXPECT_EQ(errorOf([&] { readTimes(file(mark)); }), path_ + ": holds no times");
}

TEST_F(TrajectoryIo, ErrorsNameFileAndLine) {
  const std::string good = std::string(kIdentityRow) + "\n";
  const auto kitti = [&](const std::string& content) { return errorOf([&] { readKittiTrajectory(file(content)); }); };
  EXPECT_EQ(kitti(good + "1 0 0 0 0 1 0 0 0 0 1\n"), path_ + ":2: expected 12 numbers, found 11");
  EXPECT_EQ(kitti(good + kIdentityRow + " 7\n"), path_ + ":2: expected 12 numbers, found 13");
  EXPECT_EQ(kitti(good + good + "1 0 0 x1 0 1 0 0 0 0 1 0\n"), path_ + ":3: 'x1' is not a number; a row has 12");
  EXPECT_EQ(kitti(good + "1 0 0 nan 0 1 0 0 0 0 1 0\n"), path_ + ":2: 'nan' is not finite");
  EXPECT_EQ(kitti(good + "1 0 0 1e999 0 1 0 0 0 0 1 0\n"), path_ + ":2: '1e999' is not finite");
  EXPECT_EQ(kitti("2 0 0 0 0 1 0 0 0 0 1 0\n"), path_ + ":1: the 3x3 part is not a rotation");
  EXPECT_EQ(kitti("-1 0 0 0 0 1 0 0 0 0 1 0\n"), path_ + ":1: the 3x3 part is not a rotation");
  EXPECT_EQ(kitti(good + "\n" + good), path_ + ":2: empty line before the end of the data");
  EXPECT_EQ(kitti(""), path_ + ": holds no poses");
  EXPECT_EQ(errorOf([&] { readTimes(file("0\n0.1\n0.05\n")); }), path_ + ":3: the time goes back");
  EXPECT_EQ(errorOf([&] { readTimes(file("0\n0.1 2\n")); }), path_ + ":2: expected 1 number, found 2");
}

TEST_F(TrajectoryIo, FilesThatCannotBeOpenedAreNamed) {
  EXPECT_EQ(errorOf([] { readKittiTrajectory("/no/such/file"); }),
            "/no/such/file: cannot be opened: No such file or directory");
  EXPECT_EQ(errorOf([] { readKittiTrajectory("/"); }), "/: is a directory, not a file");
  EXPECT_EQ(errorOf([] { writeKittiTrajectory("/no/such/file", {}); }),
            "/no/such/file: cannot be written: No such file or directory");
}

TEST_F(TrajectoryIo, TimesAreReadInOrder) {
  EXPECT_EQ(readTimes(file("0.000000e+00\n1.0e-01\n1.0e-01\n")), (std::vector<double>{0.0, 0.1, 0.1}));
}

TEST_F(TrajectoryIo, CalibrationTurnsCameraMotionIntoLidarMotion) {
  // camera: x right, y down, z forward; lidar: x forward, y left, z up, 0.27 m behind the camera
  const Pose T_camera_lidar = readLidarToCamera(file("P0: 1 2 3\nTr: 0 -1 0 0 0 0 -1 -0.08 1 0 0 -0.27\n"));
  Pose forward = Pose::Identity();
  forward.translation().z() = 2.0;
  Pose left = Pose::Identity();  // a turn to the left about the camera, which looks down its y axis
  left.linear() = Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const std::vector<Pose> lidar = lidarFromCameraTrajectory({Pose::Identity(), forward, left}, T_camera_lidar);
  ASSERT_EQ(lidar.size(), 3u);
  EXPECT_TRUE(lidar[0].isApprox(Pose::Identity(), 1e-12));
  EXPECT_TRUE(lidar[1].translation().isApprox(Eigen::Vector3d(2, 0, 0), 1e-12));
  EXPECT_NEAR(rpyFromRotation(lidar[2].linear()).z(), M_PI / 2, 1e-12);
  // the lidar swings around the camera: from 0.27 m behind it to 0.27 m to its right
  EXPECT_TRUE(lidar[2].translation().isApprox(Eigen::Vector3d(0.27, -0.27, 0), 1e-12)) << lidar[2].translation();
}

TEST_F(TrajectoryIo, ACameraMovesAlongItsZAxis) {
  std::vector<Pose> lidar(20, Pose::Identity()), camera;
  Pose T_camera_lidar = Pose::Identity();
  T_camera_lidar.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  for (int i = 0; i < 20; ++i) {  // a quarter of a circle
    lidar[static_cast<std::size_t>(i)].linear() = rotationFromRpy(0.0, 0.0, 0.08 * i);
    lidar[static_cast<std::size_t>(i)].translation() << 10.0 * std::sin(0.08 * i), 10.0 - 10.0 * std::cos(0.08 * i),
        0.1 * i;
  }
  for (const Pose& T : lidar) camera.push_back(T_camera_lidar * T * T_camera_lidar.inverse());
  EXPECT_FALSE(movesLikeACamera(lidar));
  EXPECT_TRUE(movesLikeACamera(camera));
  EXPECT_FALSE(movesLikeACamera({}));
}

TEST_F(TrajectoryIo, CalibrationWithoutTrIsRefused) {
  EXPECT_EQ(errorOf([&] { readLidarToCamera(file("P0: 1 2 3\n")); }),
            path_ + ": has no line 'Tr:' (12 numbers, lidar to camera)");
  EXPECT_EQ(errorOf([&] { readLidarToCamera(file("P0: 1\nTr: 1 2 3\n")); }),
            path_ + ":2: expected 12 numbers, found 3");
}

namespace fs = std::filesystem;

constexpr const char* kForward = "1 0 0 2 0 1 0 0 0 0 1 0\n";  // 2 m along the first axis
constexpr const char* kIdentity = "1 0 0 0 0 1 0 0 0 0 1 0\n";
// camera x = -lidar y, y = -lidar z, z = lidar x
constexpr const char* kCalib = "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n";

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
}  // namespace fail_aware::trajectory_io_test
