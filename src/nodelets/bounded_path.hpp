// The driven path for display: one pose per `spacing_m`; the oldest poses are dropped at the limit.
#pragma once

#include <nav_msgs/Path.h>

#include <boost/make_shared.hpp>
#include <cstddef>
#include <deque>

#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"

namespace fail_aware {

class BoundedPath {
 public:
  BoundedPath(std::size_t max_poses, double spacing_m) : max_poses_(max_poses), spacing_m_(spacing_m) {}

  /// False if the pose is too close to the last one; then nothing changes.
  bool add(const Pose& T_odom_base, const std_msgs::Header& header) {
    const Eigen::Vector3d position = T_odom_base.translation();
    if (!poses_.empty() && (position - end_odom_).norm() < spacing_m_) return false;
    end_odom_ = position;
    geometry_msgs::PoseStamped pose;
    pose.header = header;
    pose.pose = toPoseMessage(T_odom_base);
    poses_.push_back(pose);
    if (poses_.size() > max_poses_) poses_.pop_front();
    return true;
  }

  nav_msgs::PathConstPtr message() const {
    const auto message = boost::make_shared<nav_msgs::Path>();
    if (!poses_.empty()) message->header = poses_.back().header;
    message->poses.assign(poses_.begin(), poses_.end());
    return message;
  }

  void clear() { poses_.clear(); }

 private:
  std::size_t max_poses_;
  double spacing_m_;
  std::deque<geometry_msgs::PoseStamped> poses_;
  Eigen::Vector3d end_odom_ = Eigen::Vector3d::Zero();
};

}  // namespace fail_aware
