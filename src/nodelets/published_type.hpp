// Explains why no cloud arrives: the cloud topic has no publisher, or another type is published on it (roscpp only
// reports that md5sums differ).
#pragma once

#include <ros/master.h>
#include <ros/this_node.h>

#include <string>

namespace fail_aware {

/// The published type according to the master; empty: no publisher, or the master does not answer (asked once).
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

/// One line for the user. `type`: publishedType(topic).
inline std::string whyNoCloud(const std::string& topic, const std::string& type) {
  if (type.empty()) return "no cloud yet: nobody publishes " + topic + " (another topic: cloud:=/your/points)";
  if (!isAnotherType(type)) return "no cloud yet on " + topic;
  return "no cloud yet: " + topic + " carries " + type + ", and the odometry reads sensor_msgs/PointCloud2: give the " +
         "topic of the lidar's clouds (cloud:=/your/points)";
}

}  // namespace fail_aware
