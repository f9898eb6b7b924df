#include "../../src/nodelets/pose_message.hpp"

#include <gtest/gtest.h>

namespace fail_aware::pose_message_test {
namespace {

geometry_msgs::PoseWithCovarianceStamped message() {
  geometry_msgs::PoseWithCovarianceStamped out;
  out.header.frame_id = "/odom";
  out.header.stamp = ros::Time(100, 500000000);
  out.pose.pose.position.x = 5.0;
  out.pose.pose.orientation.w = 1.0;
  out.pose.covariance = toCovarianceMessage(0.01 * Matrix6d::Identity());
  return out;
}

TEST(PoseMessage, IsAPoseInOdom) {
  std::string reason;
  const std::optional<ExternalPose> pose = poseInOdom(message(), "odom", reason);
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->stamp_s, 100.5);
  EXPECT_EQ(pose->T_odom_base.translation().x(), 5.0);
  EXPECT_EQ(pose->covariance(5, 5), 0.01);
}

TEST(PoseMessage, MeasurementNeedsACovariance) {
  messages::PoseMeasurement answer;
  answer.header.frame_id = "odom";
  answer.status = messages::PoseMeasurement::OK;
  answer.pose.orientation.w = 1.0;
  const auto reasonFor = [&] {
    std::string reason;
    const bool ok = measurementInOdom(answer, "/odom", reason).ok();
    EXPECT_EQ(ok, reason.empty());
    return reason;
  };
  EXPECT_NE(reasonFor().find("covariance"), std::string::npos) << "all zero would mean exact";
  answer.covariance[0] = answer.covariance[7] = answer.covariance[14] = 1.0;
  EXPECT_NE(reasonFor().find("rotation"), std::string::npos);
  answer.covariance[21] = answer.covariance[28] = answer.covariance[35] = 1e4;
  EXPECT_EQ(reasonFor(), "");
  answer.header.frame_id = "map";
  EXPECT_NE(reasonFor().find("map"), std::string::npos);
}

TEST(PoseMessage, SaysWhyItIsRefused) {
  std::string reason;
  geometry_msgs::PoseWithCovarianceStamped bad = message();
  bad.header.frame_id = "map";
  EXPECT_FALSE(poseInOdom(bad, "odom", reason));
  EXPECT_NE(reason.find("map"), std::string::npos);
  bad = message();
  bad.pose.pose.orientation.w = 3.0;
  EXPECT_FALSE(poseInOdom(bad, "odom", reason));
  EXPECT_NE(reason.find("quaternion"), std::string::npos);
}

}  // namespace
}  // namespace fail_aware::pose_message_test
