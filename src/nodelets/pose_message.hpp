// Converts a set_pose message into an external pose. Refused, with a reason: another frame, no unit quaternion.
#pragma once

#include <geometry_msgs/PoseWithCovarianceStamped.h>

#include <optional>
#include <string>

#include "fail_aware_lidar_odometry/bridge/frame_name.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"
#include "fail_aware_lidar_odometry/sweep.hpp"

namespace fail_aware {

/// `reason`: set if the pose is refused.
inline std::optional<ExternalPose> poseInOdom(const geometry_msgs::PoseWithCovarianceStamped& message,
                                              const std::string& odom_frame, std::string& reason) {
  const std::string frame = withoutSlash(message.header.frame_id);
  const std::optional<Pose> T_odom_base = fromMessage(message.pose.pose);
  if (frame != withoutSlash(odom_frame)) {
    reason = "its frame is '" + frame + "', it must be " + odom_frame;
    return std::nullopt;
  }
  if (!T_odom_base) {
    reason = "the pose is not valid (orientation must be a unit quaternion)";
    return std::nullopt;
  }
  return ExternalPose{message.header.stamp.toSec(), *T_odom_base, fromMessage(message.pose.covariance)};
}

}  // namespace fail_aware
