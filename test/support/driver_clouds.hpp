// The made-up street's sweeps as different drivers pack them into a PointCloud2.
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <functional>

#include "graph_driver.hpp"

namespace fail_aware {

/// As the Noetic velodyne driver packs: 22 bytes a point, ring and time not aligned.
sensor_msgs::PointCloud2Ptr velodyneCloud(int i, const std::function<float(float)>& time_of);

/// As kitti2bag packs: x y z i.
sensor_msgs::PointCloud2Ptr kittiCloud(int i);

/// Rows of 100 points with a NaN after every ninth, the last row filled up with them, and padding after each row.
sensor_msgs::PointCloud2Ptr organisedCloud(int i);

}  // namespace fail_aware
