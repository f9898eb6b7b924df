#include "bridge/velodyne_bag_writer.hpp"

#include <tf2_msgs/TFMessage.h>

#include <algorithm>

namespace fail_aware {

namespace {

constexpr std::uint32_t kEpoch_s = 1577836800;  // 2020-01-01: start of simulated drives
const ros::Duration kPlaceLead(0.5);

}  // namespace

VelodyneBagWriter::VelodyneBagWriter(const std::string& path, const Pose& T_base_lidar)
    : T_base_lidar_(T_base_lidar), bag_(path), epoch_(kEpoch_s, 0), last_(epoch_) {}

void VelodyneBagWriter::add(const Sweep& sweep, const Pose& T_world_base, double true_stamp_s) {
  last_ = std::max(last_, timeAt(epoch_, true_stamp_s));
  if (!started_) {
    started_ = true;
    T_world_first_ = T_world_base;
    tf2_msgs::TFMessage place;
    const ros::Time before = last_ - kPlaceLead;
    place.transforms.push_back(lidarPlace(T_base_lidar_, names_, before));
    bag_.writeLatched("/tf_static", before, place, "/simulate_drive");
  }
  sensor_msgs::PointCloud2 cloud;
  writeVelodyneCloud(sweep, cloud);
  cloud.header.frame_id = names_.lidar_frame;
  cloud.header.stamp = timeAt(epoch_, sweep.stamp_s);
  bag_.write("/" + names_.cloud_topic, last_, cloud);
  bag_.write("/" + names_.ground_truth_topic, last_,
             groundTruth(T_world_first_.inverse() * T_world_base, names_, timeAt(epoch_, true_stamp_s)));
}

}  // namespace fail_aware
