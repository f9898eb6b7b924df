// What is wrong with the clouds' topic while no cloud comes: nobody publishes it, or something else than clouds is
// published there (roscpp says only that md5sums do not match, and not what to do).
#pragma once

#include <ros/master.h>
#include <ros/this_node.h>

#include <string>

namespace fail_aware {

/// The type that is published there, by the master; empty: nobody publishes it, or the master does not answer (it is
/// asked once, not waited for).
inline std::string publishedType(const std::string& topic) {
  XmlRpc::XmlRpcValue request, response, published;
  request[0] = ros::this_node::getName();
  request[1] = std::string();
  if (!ros::master::execute("getPublishedTopics", request, response, published, false)) return "";
  for (int i = 0; i < published.size(); ++i) {
    if (static_cast<std::string>(published[i][0]) == topic) return static_cast<std::string>(published[i][1]);
  }
  return "";
}

inline bool isAnotherType(const std::string& type) { return !type.empty() && type != "sensor_msgs/PointCloud2"; }

/// One line for people. `type`: publishedType(topic).
inline std::string whyNoCloud(const std::string& topic, const std::string& type) {
  if (type.empty()) return "no cloud yet: nobody publishes " + topic;
  if (!isAnotherType(type)) return "no cloud yet on " + topic;
  return "no cloud yet: " + topic + " carries " + type + ", and the odometry reads sensor_msgs/PointCloud2: give the " +
         "topic of the lidar's clouds (cloud:=/your/points)";
}

}  // namespace fail_aware
