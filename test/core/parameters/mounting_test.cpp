#include "core/parameters/mounting.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "core/io/profile_files.hpp"
#include "error_of.hpp"

namespace fail_aware::mounting_test {
namespace {

std::string refusal(const std::vector<double>& mounting) {
  return errorOf([&] { requireMounting("place", mounting); });
}

TEST(Mounting, IsSixNumbersInMetresAndRadians) {
  EXPECT_EQ(refusal({-0.6, 0.1, 1.73, 0.01, -0.02, 3.1416}), kNoError);
  EXPECT_EQ(refusal({-0.6, 0.1, 1.73}), "place: must be 6 finite numbers, has 3");
  EXPECT_EQ(refusal({-0.6, 0.1, 1730, 0, 0, 0}), "place = 1730: must be in [-100, 100]");
  EXPECT_EQ(refusal({0, 0, 0, 0, 0, -90}), "place = -90: must be in [-3.15, 3.15] where it is an angle: rad, not deg");
  EXPECT_EQ(refusal({0, 0, 0, 0, 0, std::numeric_limits<double>::quiet_NaN()}),
            "place: must be 6 finite numbers, has one that is not");
}

TEST(Mounting, IsThePoseOfItsNumbers) {
  const Pose T = mountingPose({1, 2, 3, 0, 0, 0.5});
  EXPECT_TRUE(T.translation().isApprox(Eigen::Vector3d(1, 2, 3)));
  EXPECT_TRUE(T.linear().isApprox(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()).toRotationMatrix(), 1e-12));
}

TEST(Mounting, ThePlaceholderOfTheShippedSensorFilesIsTold) {
  for (const char* sensor : {"velodyne", "ouster", "hesai"}) {
    ProfileFiles files;
    files.sensor = sensor;
    EXPECT_NE(placeholderFault(loadPipelineParameters(files).sensor.lidar_in_base), "") << sensor;
  }
  EXPECT_EQ(placeholderFault(loadPipelineParameters({}).sensor.lidar_in_base), "") << "KITTI's is measured";
  EXPECT_EQ(placeholderFault({0.0, 0.0, 1.81, 0.0, 0.0, 0.0}), "");
}

}  // namespace
}  // namespace fail_aware::mounting_test
