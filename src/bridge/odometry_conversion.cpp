#include "bridge/odometry_conversion.hpp"

#include "core/estimation/increment_covariance.hpp"

namespace fail_aware {

namespace {

struct Twist {
  Vector6d mean = Vector6d::Zero();
  Matrix6d covariance;
};

Twist twistOf(const FilterState& state, const Pose& T_base_cog) {
  const Pose T_cog_base = T_base_cog.inverse();
  const Pose T_increment = T_base_cog * state.T_previous_now * T_cog_base;
  const Matrix6d about_base = rotateCovariance(state.increment_covariance, T_base_cog.linear());
  const Matrix6d covariance = covarianceAfterOffset(about_base, T_base_cog * state.T_previous_now, T_cog_base);
  const std::optional<Vector6d> twist = twistFromIncrement(T_increment, state.dt_s);
  const std::optional<Matrix6d> twist_covariance = twistCovariance(covariance, T_increment, state.dt_s);
  if (!twist || !twist_covariance) return {Vector6d::Zero(), isotropicCovariance(kUnknownSpeed_mps, kUnknownRate_rps)};
  return {*twist, *twist_covariance};
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
  const Twist twist = twistOf(state, T_base_cog);
  message.twist.twist.linear.x = twist.mean[0];
  message.twist.twist.linear.y = twist.mean[1];
  message.twist.twist.linear.z = twist.mean[2];
  message.twist.twist.angular.x = twist.mean[3];
  message.twist.twist.angular.y = twist.mean[4];
  message.twist.twist.angular.z = twist.mean[5];
  message.twist.covariance = toCovarianceMessage(twist.covariance);
  return message;
}

}  // namespace fail_aware
