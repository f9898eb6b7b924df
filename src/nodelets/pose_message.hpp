// Converts poses from outside: set_pose into an external pose, the answer of an extra source into a measurement.
// Refused, with a reason: another frame, no unit quaternion, a covariance that is not positive definite.
#pragma once

#include <geometry_msgs/PoseWithCovarianceStamped.h>

#include <optional>
#include <string>

#include "bridge/graph_message_conversion.hpp"
#include "core/estimation/external_pose.hpp"
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

/// A measurement without a pose if it is refused. `reason`: set then.
inline Measurement measurementInOdom(const messages::PoseMeasurement& message, const std::string& odom_frame,
                                     std::string& reason) {
  const std::string frame = withoutSlash(message.header.frame_id);
  Measurement measurement = fromMessage(message);
  measurement.clock_jump_suspected = false;  // only built-in sources can detect it
  if (frame != withoutSlash(odom_frame)) {
    reason = "its frame is " + frame + ", must be " + odom_frame;
  } else if (measurement.ok()) {
    reason = rotationMeasured(measurement.covariance)
                 ? unusableReason(measurement.covariance)
                 : "the rotation's covariance is zero: give a rotation that is not measured 1e4 rad^2";
  }
  return reason.empty() ? measurement : Measurement();
}

}  // namespace fail_aware
