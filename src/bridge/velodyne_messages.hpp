// Makes from a sweep what a vehicle with a Velodyne publishes: the driver's cloud, the lidar's mounting and, if known,
// the true odometry.
//
// Cloud: x y z intensity (FLOAT32), ring (UINT16), time (FLOAT32, s relative to the stamp, which is the sweep's end),
// point_step 22, like velodyne_pointcloud. Missing rings and times become 0. Header stamps: seconds from `epoch`,
// to the microsecond.
#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/PointCloud2.h>

#include <string>

#include "core/geometry/pose.hpp"
#include "fail_aware_lidar_odometry/sweep.hpp"

namespace fail_aware {

struct VelodyneNames {
  std::string cloud_topic = "velodyne_points";
  std::string ground_truth_topic = "ground_truth/odometry";
  std::string base_frame = "base_link";
  std::string lidar_frame = "velodyne";
  std::string ground_truth_frame = "ground_truth";

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("cloud_topic", self.cloud_topic);
    v("ground_truth_topic", self.ground_truth_topic);
    v("base_frame", self.base_frame);
    v("lidar_frame", self.lidar_frame);
    v("ground_truth_frame", self.ground_truth_frame);
  }
};

ros::Time timeAt(const ros::Time& epoch, double seconds);

/// Sets fields, sizes and data; the caller sets the header.
void writeVelodyneCloud(const Sweep& sweep, sensor_msgs::PointCloud2& cloud);

geometry_msgs::TransformStamped lidarPlace(const Pose& T_base_lidar, const VelodyneNames& names,
                                           const ros::Time& stamp);

/// Pose of base_link in the ground truth's frame; twist and covariances zero.
nav_msgs::Odometry groundTruth(const Pose& T_truth_base, const VelodyneNames& names, const ros::Time& stamp);

}  // namespace fail_aware
