#include "fail_aware_lidar_odometry/bridge/velodyne_bag_writer.hpp"

#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <stdexcept>

#include "fail_aware_lidar_odometry/core/io/input_error.hpp"

namespace fail_aware {

namespace {

constexpr std::uint32_t kEpoch_s = 1577836800;  // 2020-01-01: made-up drives begin then

}  // namespace

VelodyneBagWriter::VelodyneBagWriter(const std::string& path, const Pose& T_base_lidar)
    : path_(path), T_base_lidar_(T_base_lidar), epoch_(kEpoch_s, 0), last_(epoch_) {
  try {
    bag_.open(path, rosbag::bagmode::Write);
  } catch (const rosbag::BagException& error) {
    throw InputError(path + ": cannot be written: " + error.what());
  }
}

void VelodyneBagWriter::add(const Sweep& sweep, const Pose& T_world_base, double true_stamp_s) {
  try {
    // late sweeps arrive late, but nothing is recorded before what was recorded already
    last_ = std::max(last_, timeAt(epoch_, true_stamp_s));
    if (!started_) {
      started_ = true;
      T_world_first_ = T_world_base;
      tf2_msgs::TFMessage transforms;
      transforms.transforms.push_back(lidarPlace(T_base_lidar_, names_, last_));
      const auto header = boost::make_shared<ros::M_string>();
      (*header)["latching"] = "1";
      (*header)["callerid"] = "/simulate_drive";
      bag_.write("/tf_static", last_, transforms, header);
    }
    sensor_msgs::PointCloud2 cloud;
    writeVelodyneCloud(sweep, cloud);
    cloud.header.frame_id = names_.lidar_frame;
    cloud.header.stamp = timeAt(epoch_, sweep.stamp_s);
    bag_.write("/" + names_.cloud_topic, last_, cloud);
    bag_.write("/" + names_.ground_truth_topic, last_,
               groundTruth(T_world_first_.inverse() * T_world_base, names_, timeAt(epoch_, true_stamp_s)));
  } catch (const rosbag::BagException& error) {
    throw std::runtime_error(path_ + ": cannot be written: " + error.what());
  }
}

void VelodyneBagWriter::close() { bag_.close(); }

}  // namespace fail_aware
