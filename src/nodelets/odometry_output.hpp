// What FusionUkf says of base_link: odometry, path, tf, and every pose on demand (service ~save_trajectory).
#pragma once

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/transform_broadcaster.h>

#include <memory>
#include <mutex>
#include <string>

#include "bounded_path.hpp"
#include "fail_aware_lidar_odometry/core/types/filter_state.hpp"
#include "fusion_ukf_params.hpp"
#include "trajectory_record.hpp"

namespace fail_aware {

class OdometryOutput {
 public:
  OdometryOutput(ros::NodeHandle node, ros::NodeHandle private_node, const FusionUkfNodeletParams& params,
                 const Pose& T_base_cog);
  ~OdometryOutput();

  /// Into the trajectory.
  void record(const FilterState& state);
  /// `covariance`: of the pose of the centre of gravity since the start (OdometryCovariance). `header`: the sweep's
  /// stamp, the odometry's frame.
  void publish(const FilterState& state, const Matrix6d& covariance, const std_msgs::Header& header);
  /// Path and trajectory begin anew.
  void clear();

 private:
  /// In a thread of its own: a slow disk must not hold up the estimates.
  bool onSave(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response);

  ros::NodeHandle private_node_;
  std::string base_frame_;
  std::string trajectory_file_;
  Pose T_base_cog_;
  BoundedPath path_;
  std::mutex trajectory_mutex_;
  TrajectoryRecord trajectory_;
  std::unique_ptr<tf2_ros::TransformBroadcaster> tf_broadcaster_;
  ros::Publisher odometry_publisher_, path_publisher_;
  ros::CallbackQueue saving_;
  ros::ServiceServer save_service_;
  ros::AsyncSpinner saver_{1, &saving_};
};

}  // namespace fail_aware
