#include "fusion_output.hpp"

#include <nav_msgs/Odometry.h>

#include <boost/make_shared.hpp>

#include "bridge/odometry_conversion.hpp"
#include "fail_aware_lidar_odometry/bridge/frame_name.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"
#include "topics.hpp"

namespace fail_aware {

FusionOutput::FusionOutput(ros::NodeHandle& node, const ros::NodeHandle& private_node,
                           const FusionUkfNodeletParams& params, const Pose& T_base_cog)
    : odom_frame_(withoutSlash(params.odom_frame)),
      base_frame_(withoutSlash(params.base_frame)),
      T_base_cog_(T_base_cog),
      path_(static_cast<std::size_t>(params.path_max_poses), params.path_spacing_m),
      trajectory_(private_node, params.trajectory_file, static_cast<std::size_t>(params.trajectory_max_poses)) {
  if (params.publish_tf) tf_broadcaster_ = std::make_unique<tf2_ros::TransformBroadcaster>();
  prediction_publisher_ = node.advertise<messages::SweepPrediction>(topics::kSweepPrediction, topics::kQueue);
  state_publisher_ = node.advertise<messages::FilterState>(topics::kFilterState, topics::kQueue);
  odometry_publisher_ = node.advertise<nav_msgs::Odometry>(topics::kOdometry, topics::kQueue);
  path_publisher_ = node.advertise<nav_msgs::Path>(topics::kPath, 1);
}

void FusionOutput::publishPrediction(const SweepTask& task, const ros::Time& stamp) {
  prediction_publisher_.publish(messages::SweepPredictionConstPtr(
      boost::make_shared<messages::SweepPrediction>(toMessage(task, headerAt(stamp), last_stamp_))));
}

void FusionOutput::publishEstimate(const Estimator& estimator, const SweepAccount& account, const ros::Time& stamp) {
  const FilterState& state = estimator.state();
  const std_msgs::Header header = headerAt(stamp);
  last_stamp_ = stamp;
  // before publishing, so that a client that then calls ~save_trajectory gets this pose
  trajectory_.add(state.stamp_s, state.T_odom_cog * T_base_cog_.inverse());
  state_publisher_.publish(
      messages::FilterStateConstPtr(boost::make_shared<messages::FilterState>(toMessage(state, account, header))));
  publishBase(estimator, header);
}

void FusionOutput::publishBase(const Estimator& estimator, const std_msgs::Header& header) {
  const FilterState state = estimator.stateAsDriven();
  const auto odometry = boost::make_shared<nav_msgs::Odometry>(
      toOdometryMessage(state, estimator.odometryCovariance(), T_base_cog_, header.frame_id, base_frame_));
  odometry->header.stamp = header.stamp;
  odometry_publisher_.publish(nav_msgs::OdometryConstPtr(odometry));
  const Pose T_odom_base = state.T_odom_cog * T_base_cog_.inverse();
  if (tf_broadcaster_) {
    geometry_msgs::TransformStamped transform;
    transform.header = header;
    transform.child_frame_id = base_frame_;
    transform.transform = toTransformMessage(T_odom_base);
    tf_broadcaster_->sendTransform(transform);
  }
  if (path_.add(T_odom_base, header) && path_publisher_.getNumSubscribers() > 0) {
    path_publisher_.publish(path_.message());
  }
}

void FusionOutput::clear() {
  last_stamp_ = ros::Time();
  path_.clear();
  trajectory_.clear();
}

std_msgs::Header FusionOutput::headerAt(const ros::Time& stamp) const {
  std_msgs::Header header;
  header.stamp = stamp;
  header.frame_id = odom_frame_;
  return header;
}

}  // namespace fail_aware
