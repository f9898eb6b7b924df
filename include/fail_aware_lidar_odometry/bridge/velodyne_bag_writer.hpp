// Writes a drive as a bag recorded on a vehicle with a Velodyne (velodyne_messages.hpp): /velodyne_points, /tf_static, and the truth
// on /ground_truth/odometry.
//
// Failure: InputError if the bag cannot be opened; std::runtime_error if writing fails.
#pragma once

#include <rosbag/bag.h>

#include <string>

#include "fail_aware_lidar_odometry/bridge/velodyne_messages.hpp"

namespace fail_aware {

class VelodyneBagWriter {
 public:
  VelodyneBagWriter(const std::string& path, const Pose& T_base_lidar);

  /// The driver's sweep (stamp: its end). T_world_base: the truth at true_stamp_s, which is also when it was recorded.
  void add(const Sweep& sweep, const Pose& T_world_base, double true_stamp_s);
  void close();

 private:
  VelodyneNames names_;
  std::string path_;
  Pose T_base_lidar_;
  rosbag::Bag bag_;
  ros::Time epoch_;
  ros::Time last_;
  bool started_ = false;
  Pose T_world_first_ = Pose::Identity();
};

}  // namespace fail_aware
