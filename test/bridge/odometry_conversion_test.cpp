#include "bridge/odometry_conversion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/decompositions.hpp"

namespace fail_aware::odometry_conversion_test {
namespace {

TEST(OdometryMessage, IsThatOfTheBaseWithTwistInIt) {
  Pose T_base_cog = Pose::Identity();
  T_base_cog.translation() << 0.3, 0.0, 0.5;
  Vector6d twist = Vector6d::Zero();
  twist[0] = 10.0;
  twist[5] = 0.2;
  const Pose T_odom_base = poseFromVector((Vector6d() << 5, 6, 0, 0, 0, 1.0).finished());
  FilterState state;
  state.dt_s = 0.1;
  state.T_odom_cog = T_odom_base * T_base_cog;
  state.T_previous_now = T_base_cog.inverse() * expSe3(0.1 * twist) * T_base_cog;
  state.increment_covariance = 1e-4 * Matrix6d::Identity();
  const nav_msgs::Odometry message =
      toOdometryMessage(state, 1e-2 * Matrix6d::Identity(), T_base_cog, "odom", "base_link");
  EXPECT_EQ(message.header.frame_id, "odom");
  EXPECT_EQ(message.child_frame_id, "base_link");
  EXPECT_TRUE(fromMessage(message.pose.pose)->isApprox(T_odom_base, 1e-12));
  EXPECT_NEAR(message.twist.twist.linear.x, 10.0, 1e-9);
  EXPECT_NEAR(message.twist.twist.linear.y, 0.0, 1e-9);
  EXPECT_NEAR(message.twist.twist.angular.z, 0.2, 1e-9);
  for (const CovarianceMessage& covariance : {message.pose.covariance, message.twist.covariance}) {
    const Matrix6d C = fromMessage(covariance);
    EXPECT_TRUE(C.isApprox(C.transpose(), 1e-12));
    EXPECT_GT(symmetricEigenvalues(C)[0], 0.0);
  }
  // the lever arm turns heading error into lateral error of base_link
  EXPECT_NEAR(fromMessage(message.pose.covariance).trace(), 0.06 + 2 * 1e-2 * (0.09 + 0.25), 1e-9);
}

void expectUnknownTwist(const nav_msgs::Odometry& message) {
  EXPECT_EQ(message.twist.twist.linear.x, 0.0);
  EXPECT_EQ(message.twist.twist.angular.z, 0.0);
  const Vector6d variances = symmetricEigenvalues(fromMessage(message.twist.covariance));
  EXPECT_GE(variances[0], 100.0 * 100.0) << "rad^2/s^2: no measurement";
  EXPECT_LE(variances[5], 1000.0 * variances[0]) << "can be inverted";
  const Matrix6d C = fromMessage(message.twist.covariance);
  EXPECT_GE(C(0, 0), 1000.0 * 1000.0) << "m^2/s^2";
}

TEST(OdometryMessage, AFirstSweepsTwistIsUnknown) {
  expectUnknownTwist(toOdometryMessage(FilterState(), Matrix6d::Identity(), Pose::Identity(), "odom", "base_link"));
}

TEST(OdometryMessage, ATwistThatIsNotFiniteIsUnknown) {
  FilterState state;
  state.dt_s = 0.1;
  state.increment_covariance = 1e-4 * Matrix6d::Identity();
  FilterState bad_motion = state, bad_covariance = state;
  bad_motion.T_previous_now.translation().x() = std::nan("");
  bad_covariance.increment_covariance(0, 0) = std::nan("");
  for (const FilterState& bad : {bad_motion, bad_covariance}) {
    expectUnknownTwist(toOdometryMessage(bad, Matrix6d::Identity(), Pose::Identity(), "odom", "base_link"));
  }
}

}  // namespace
}  // namespace fail_aware::odometry_conversion_test
