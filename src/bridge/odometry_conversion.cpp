#include "fail_aware_lidar_odometry/bridge/odometry_conversion.hpp"

namespace fail_aware {

namespace {

void setTwist(const FilterState& state, const Pose& T_base_cog, geometry_msgs::TwistWithCovariance& message) {
  const Pose T_cog_base = T_base_cog.inverse();
  const Pose T_increment = T_base_cog * state.T_previous_now * T_cog_base;
  const std::optional<Vector6d> twist = twistFromIncrement(T_increment, state.dt_s);
  if (!twist) return;
  const Matrix6d about_base = rotateCovariance(state.increment_covariance, T_base_cog.linear());
  const Matrix6d covariance = covarianceAfterOffset(about_base, T_base_cog * state.T_previous_now, T_cog_base);
  const std::optional<Matrix6d> twist_covariance = twistCovariance(covariance, T_increment, state.dt_s);
  if (!twist_covariance) return;
  message.twist.linear.x = (*twist)[0];
  message.twist.linear.y = (*twist)[1];
  message.twist.linear.z = (*twist)[2];
  message.twist.angular.x = (*twist)[3];
  message.twist.angular.y = (*twist)[4];
  message.twist.angular.z = (*twist)[5];
  message.covariance = toCovarianceMessage(*twist_covariance);
}

}  // namespace

nav_msgs::Odometry toOdometryMessage(const FilterState& state, const Matrix6d& odometry_covariance,
                                     const Pose& T_base_cog, const std::string& odom_frame,
                                     const std::string& base_frame) {
  const Pose T_cog_base = T_base_cog.inverse();
  nav_msgs::Odometry message;
  message.header.frame_id = odom_frame;
  message.child_frame_id = base_frame;
  message.pose.pose = toPoseMessage(state.T_odom_cog * T_cog_base);
  message.pose.covariance =
      toCovarianceMessage(covarianceAfterOffset(odometry_covariance, state.T_odom_cog, T_cog_base));
  setTwist(state, T_base_cog, message.twist);
  return message;
}

}  // namespace fail_aware
