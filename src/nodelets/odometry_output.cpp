#include "odometry_output.hpp"

#include <nav_msgs/Odometry.h>

#include <boost/make_shared.hpp>
#include <filesystem>
#include <stdexcept>

#include "fail_aware_lidar_odometry/bridge/odometry_conversion.hpp"
#include "fail_aware_lidar_odometry/bridge/parameter_server.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"
#include "topics.hpp"

namespace fail_aware {

OdometryOutput::OdometryOutput(ros::NodeHandle node, ros::NodeHandle private_node, const FusionUkfNodeletParams& params,
                               const Pose& T_base_cog)
    : private_node_(private_node),
      base_frame_(params.base_frame),
      trajectory_file_(params.trajectory_file),
      T_base_cog_(T_base_cog),
      path_(static_cast<std::size_t>(params.path_max_poses), params.path_spacing_m),
      trajectory_(static_cast<std::size_t>(params.trajectory_max_poses)) {
  if (params.publish_tf) tf_broadcaster_ = std::make_unique<tf2_ros::TransformBroadcaster>();
  odometry_publisher_ = node.advertise<nav_msgs::Odometry>(topics::kOdometry, topics::kQueue);
  path_publisher_ = node.advertise<nav_msgs::Path>(topics::kPath, 1);
  private_node.setCallbackQueue(&saving_);
  save_service_ = private_node.advertiseService("save_trajectory", &OdometryOutput::onSave, this);
  saver_.start();
}

OdometryOutput::~OdometryOutput() {
  saver_.stop();  // waits for a call that is under way
}

void OdometryOutput::record(const FilterState& state) {
  const std::lock_guard<std::mutex> lock(trajectory_mutex_);
  trajectory_.add(state.stamp_s, state.T_odom_cog * T_base_cog_.inverse());
}

void OdometryOutput::publish(const FilterState& state, const Matrix6d& covariance, const std_msgs::Header& header) {
  const auto odometry = boost::make_shared<nav_msgs::Odometry>(
      toOdometryMessage(state, covariance, T_base_cog_, header.frame_id, base_frame_));
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

void OdometryOutput::clear() {
  path_.clear();
  const std::lock_guard<std::mutex> lock(trajectory_mutex_);
  trajectory_.clear();
}

bool OdometryOutput::onSave(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  // may have been set meanwhile
  const std::string file = readText(private_node_, "trajectory_file", trajectory_file_);
  std::error_code error;
  const std::filesystem::path path = std::filesystem::absolute(file, error);
  std::unique_lock<std::mutex> lock(trajectory_mutex_);
  const TrajectoryRecord trajectory = trajectory_;
  lock.unlock();
  try {
    if (trajectory.size() == 0) throw std::runtime_error("there is no pose yet");
    trajectory.save(path.string());
    response.success = true;
    response.message = path.string() + ": " + std::to_string(trajectory.size()) + " poses";
    if (trajectory.forgotten() > 0) {
      response.message +=
          " (the first " + std::to_string(trajectory.forgotten()) + " were forgotten, see " + "trajectory_max_poses)";
    }
  } catch (const std::exception& failure) {
    response.success = false;
    response.message = failure.what();
  }
  return true;
}

}  // namespace fail_aware
