// Writes a drive as a bag that looks recorded on a vehicle with a Velodyne (velodyne_messages.hpp): /velodyne_points,
// /tf_static, and the ground truth on /ground_truth/odometry.
//
// Recording times never decrease, whatever the stamps are. The lidar's mounting comes half a second before the first
// cloud, so that a listener receives it in time. Failure: as bag_file.hpp.
#pragma once

#include <string>

#include "bridge/velodyne_messages.hpp"
#include "fail_aware_lidar_odometry/bridge/bag_file.hpp"

namespace fail_aware {

class VelodyneBagWriter {
 public:
  VelodyneBagWriter(const std::string& path, const Pose& T_base_lidar);

  /// The driver's sweep (stamp: its end). T_world_base: ground truth at true_stamp_s, which is also the recording time.
  void add(const Sweep& sweep, const Pose& T_world_base, double true_stamp_s);
  void close() { bag_.close(); }

 private:
  VelodyneNames names_;
  Pose T_base_lidar_;
  BagFile bag_;
  ros::Time epoch_;
  ros::Time last_;
  bool started_ = false;
  Pose T_world_first_ = Pose::Identity();
};

}  // namespace fail_aware
