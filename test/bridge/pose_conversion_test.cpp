#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace fail_aware::pose_conversion_test {
namespace {

TEST(PoseMessage, ThereAndBack) {
  const Pose T = poseFromVector((Vector6d() << 1, -2, 3, 0.1, -0.2, 3.1).finished());
  EXPECT_GE(toPoseMessage(T).orientation.w, 0.0);
  EXPECT_TRUE(fromMessage(toPoseMessage(T))->isApprox(T, 1e-14));
  EXPECT_TRUE(fromMessage(toTransformMessage(T))->isApprox(T, 1e-14));
}

TEST(PoseMessage, RefusesWhatIsNoPose) {
  EXPECT_FALSE(fromMessage(geometry_msgs::Pose()));
  geometry_msgs::Pose message = toPoseMessage(Pose::Identity());
  message.position.y = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(fromMessage(message));
}

TEST(CovarianceMessage, IsRowMajor) {
  Matrix6d covariance = Matrix6d::Zero();
  covariance(0, 5) = 7.0;
  EXPECT_EQ(toCovarianceMessage(covariance)[5], 7.0);
  EXPECT_EQ(fromMessage(toCovarianceMessage(covariance)), covariance);
}

}  // namespace
}  // namespace fail_aware::pose_conversion_test
