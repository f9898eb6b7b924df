// Everything that FusionUkf publishes: sweep/prediction when it opens a sweep; filter_state, odometry, tf and path when
// it closes one. Poses and covariances are those of core/estimator.hpp (centre of gravity in odom; m, rad); odometry,
// tf, path and ~save_trajectory are of base_link. Stamps are exactly the sweeps'. No failure modes.
#pragma once

#include <ros/ros.h>
#include <tf2_ros/transform_broadcaster.h>

#include <memory>
#include <string>

#include "bounded_path.hpp"
#include "bridge/graph_message_conversion.hpp"
#include "core/estimator.hpp"
#include "fusion_ukf_params.hpp"
#include "trajectory_service.hpp"

namespace fail_aware {

class FusionOutput {
 public:
  FusionOutput(ros::NodeHandle& node, const ros::NodeHandle& private_node, const FusionUkfNodeletParams& params,
               const Pose& T_base_cog);

  void publishPrediction(const SweepTask& task, const ros::Time& stamp);
  /// Publishes the result of `estimator`'s last update.
  void publishEstimate(const Estimator& estimator, const SweepAccount& account, const ros::Time& stamp);
  /// A new drive: clears path and trajectory.
  void clear();

 private:
  std_msgs::Header headerAt(const ros::Time& stamp) const;
  void publishBase(const Estimator& estimator, const std_msgs::Header& header);

  std::string odom_frame_, base_frame_;
  Pose T_base_cog_;
  ros::Time last_stamp_;  ///< of the last estimate; zero: no estimate in this drive
  BoundedPath path_;
  TrajectoryService trajectory_;
  std::unique_ptr<tf2_ros::TransformBroadcaster> tf_broadcaster_;  ///< null: tf is not published
  ros::Publisher prediction_publisher_, state_publisher_, odometry_publisher_, path_publisher_;
};

}  // namespace fail_aware
