// ~save_trajectory: writes every pose of base_link in odom since the drive began (trajectory_record.hpp) to a file. It
// has its own thread, so that a slow disk does not delay the estimates.
// Failure: the response says why nothing was written.
#pragma once

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <mutex>
#include <string>

#include "trajectory_record.hpp"

namespace fail_aware {

class TrajectoryService {
 public:
  /// `file`: used if ~trajectory_file is not set at the time of the call.
  TrajectoryService(ros::NodeHandle private_node, const std::string& file, std::size_t max_poses);
  ~TrajectoryService();

  void add(double stamp_s, const Pose& T_odom_base);
  /// A new drive.
  void clear();

 private:
  bool onSave(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response);

  ros::NodeHandle private_node_;
  std::string file_;
  std::mutex mutex_;
  TrajectoryRecord trajectory_;
  ros::CallbackQueue queue_;
  ros::ServiceServer service_;
  ros::AsyncSpinner spinner_{1, &queue_};
};

}  // namespace fail_aware
