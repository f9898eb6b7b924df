// All that FusionUkf publishes: sweep/prediction when a sweep is opened; filter_state, odometry, tf and path when it is
// closed. Poses and covariances as core/estimator.hpp has them (centre of gravity in odom; m, rad); odometry, tf, path and
// ~save_trajectory are of base_link. Stamps are the sweeps', exactly. No failure modes.
#pragma once

#include <ros/ros.h>
#include <tf2_ros/transform_broadcaster.h>

#include <memory>
#include <string>

#include "bounded_path.hpp"
#include "fail_aware_lidar_odometry/bridge/graph_message_conversion.hpp"
#include "fail_aware_lidar_odometry/core/estimator.hpp"
#include "fusion_ukf_params.hpp"
#include "trajectory_service.hpp"

namespace fail_aware {

class FusionOutput {
 public:
  FusionOutput(ros::NodeHandle& node, const ros::NodeHandle& private_node, const FusionUkfNodeletParams& params,
               const Pose& T_base_cog);

  void publishPrediction(const SweepTask& task, const ros::Time& stamp);
  /// What the last update of `estimator` gave.
  void publishEstimate(const Estimator& estimator, const SweepAccount& account, const ros::Time& stamp);
  /// A new drive: path and trajectory begin anew.
  void clear();

 private:
  std_msgs::Header headerAt(const ros::Time& stamp) const;
  void publishBase(const Estimator& estimator, const std_msgs::Header& header);

  std::string odom_frame_, base_frame_;
  Pose T_base_cog_;
  ros::Time last_stamp_;  ///< of the last estimate; zero: none in this drive
  BoundedPath path_;
  TrajectoryService trajectory_;
  std::unique_ptr<tf2_ros::TransformBroadcaster> tf_broadcaster_;  ///< null: no tf
  ros::Publisher prediction_publisher_, state_publisher_, odometry_publisher_, path_publisher_;
};

}  // namespace fail_aware
