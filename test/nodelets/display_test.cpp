// What rviz/odometry.rviz asks for and what the graph publishes for display are one: every display's class exists in
// rviz, every topic is advertised with the type that class reads, in the frames of the configuration, and a drive
// brings every namespace of markers that it lists. What rviz makes of it is looked at by scripts/check_rviz.
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <ros/package.h>
#include <ros/ros.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <visualization_msgs/MarkerArray.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "../support/graph_recorder.hpp"
#include "../support/synthetic_street.hpp"
#include "core/types/corrected_sweep.hpp"
#include "fail_aware_lidar_odometry/bridge/point_cloud_conversion.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"

namespace fail_aware::display_test {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

YAML::Node configuration() {
  return YAML::LoadFile(ros::package::getPath("fail_aware_lidar_odometry") + "/rviz/odometry.rviz");
}

YAML::Node manager() { return configuration()["Visualization Manager"]; }

/// Topic and message type of each display that has a topic.
std::map<std::string, std::string> wantedTopics() {
  const std::map<std::string, std::string> types = {{"rviz/PointCloud2", "sensor_msgs/PointCloud2"},
                                                    {"rviz/Path", "nav_msgs/Path"},
                                                    {"rviz/Odometry", "nav_msgs/Odometry"},
                                                    {"rviz/MarkerArray", "visualization_msgs/MarkerArray"}};
  std::map<std::string, std::string> wanted;
  for (const YAML::Node& display : manager()["Displays"]) {
    for (const char* key : {"Topic", "Marker Topic"}) {
      if (display[key]) wanted[display[key].as<std::string>()] = types.at(display["Class"].as<std::string>());
    }
  }
  return wanted;
}

TEST(RvizConfiguration, EveryClassExists) {
  std::ifstream file(ros::package::getPath("rviz") + "/plugin_description.xml");
  std::stringstream description;
  description << file.rdbuf();
  std::vector<std::string> classes = {manager()["Views"]["Current"]["Class"].as<std::string>()};
  for (const YAML::Node& display : manager()["Displays"]) {
    classes.push_back(display["Class"].as<std::string>());
    EXPECT_TRUE(display["Enabled"].as<bool>()) << classes.back();
  }
  EXPECT_EQ(classes.size(), 8u);
  for (const std::string& name : classes) {
    EXPECT_NE(description.str().find("name=\"" + name + '"'), std::string::npos) << name;
  }
}

TEST(RvizConfiguration, EveryTopicIsAdvertisedWithItsType) {
  const std::map<std::string, std::string> wanted = wantedTopics();
  EXPECT_EQ(wanted.size(), 5u);
  std::map<std::string, std::string> advertised;
  const auto all = [&] {
    ros::master::V_TopicInfo topics;
    ros::master::getTopics(topics);
    for (const ros::master::TopicInfo& topic : topics) advertised[topic.name] = topic.datatype;
    for (const auto& [topic, type] : wanted) {
      if (advertised.count(topic) == 0) return false;
    }
    return true;
  };
  EXPECT_TRUE(waitFor(all));
  for (const auto& [topic, type] : wanted) EXPECT_EQ(advertised[topic], type) << topic;
}

sensor_msgs::PointCloud2Ptr streetCloud(int i) {
  static const synthetic::Street street;
  const synthetic::Drive drive;
  const Sweep sweep =
      street.scan([&](double t) { return drive.T_street_base(t); }, 0.1 * i, static_cast<std::uint32_t>(i));
  const auto cloud = boost::make_shared<sensor_msgs::PointCloud2>();
  CorrectedSweep points;
  points.points_lidar = sweep.points_lidar;
  writeCloud(points, sweep.intensities, *cloud);
  cloud->header.frame_id = "velodyne";
  cloud->header.stamp = ros::Time(1317384506, 0) + ros::Duration(0.1 * i);
  return cloud;
}

/// All that came on `markers`.
struct MarkerLog {
  std::vector<Marker> markers;
  std::set<std::string> shown;  ///< namespaces

  void take(const MarkerArray& array) {
    for (const Marker& marker : array.markers) {
      markers.push_back(marker);
      if (marker.action == Marker::ADD) shown.insert(marker.ns);
    }
  }
};

TEST(Display, ADriveBringsAllThatTheConfigurationShows) {
  ros::NodeHandle node;
  MarkerLog log;
  std::vector<sensor_msgs::PointCloud2ConstPtr> maps;
  ros::Subscriber markers = node.subscribe<MarkerArray>(
      "markers", 200, [&](const visualization_msgs::MarkerArrayConstPtr& array) { log.take(*array); });
  ros::Subscriber map = node.subscribe<sensor_msgs::PointCloud2>(
      "local_map", 10, [&](const sensor_msgs::PointCloud2ConstPtr& cloud) { maps.push_back(cloud); });
  Recorder<nav_msgs::Odometry> odometry(node, "odometry");
  ros::Publisher publisher = node.advertise<sensor_msgs::PointCloud2>("/lidar/points", 10);
  tf2_ros::StaticTransformBroadcaster broadcaster;
  geometry_msgs::TransformStamped transform;
  transform.header.frame_id = "base_link";
  transform.child_frame_id = "velodyne";
  transform.transform = toTransformMessage(synthetic::Lidar().T_base_lidar);
  broadcaster.sendTransform(transform);
  ASSERT_TRUE(waitFor([&] {
    return publisher.getNumSubscribers() > 0 && odometry.connected() && markers.getNumPublishers() > 0 &&
           map.getNumPublishers() > 0;
  }));

  std::set<std::string> wanted;
  for (const YAML::Node& display : manager()["Displays"]) {
    for (const auto& ns : display["Namespaces"]) wanted.insert(ns.first.as<std::string>());
  }
  ASSERT_EQ(wanted.size(), 8u);

  std::set<ros::Time> stamps;
  ros::Time last;
  constexpr int kMaxSweeps = 40;
  for (int i = 0; i < kMaxSweeps && (log.shown != wanted || maps.empty()); ++i) {
    const sensor_msgs::PointCloud2Ptr cloud = streetCloud(i);
    last = cloud->header.stamp;
    stamps.insert(last);
    ASSERT_TRUE(waitFor([&] {
      publisher.publish(cloud);  // the first one until the transform has arrived; a repeated one is dropped
      return waitFor([&] { return odometry.count(last) > 0; }, i == 0 ? 0.5 : kPatience_s);
    })) << "sweep "
        << i;
  }
  EXPECT_TRUE(waitFor([&] { return log.shown == wanted && !maps.empty(); }));
  EXPECT_EQ(log.shown, wanted) << "namespaces: as many in the configuration as in the graph, by the same names";

  const std::string fixed_frame = manager()["Global Options"]["Fixed Frame"].as<std::string>();
  EXPECT_EQ(odometry.at(last).header.frame_id, fixed_frame);
  EXPECT_EQ(odometry.at(last).child_frame_id, manager()["Views"]["Current"]["Target Frame"].as<std::string>());
  for (const Marker& marker : log.markers) {
    EXPECT_EQ(marker.header.frame_id, fixed_frame) << marker.ns;
    if (marker.ns.rfind("seeds", 0) == 0 || marker.ns.rfind("corner", 0) == 0) {
      EXPECT_EQ(stamps.count(marker.header.stamp), 1u) << marker.ns;
    }
  }
  ASSERT_FALSE(maps.empty());
  ros::Time shown;
  for (const sensor_msgs::PointCloud2ConstPtr& cloud : maps) {
    EXPECT_EQ(cloud->header.frame_id, "velodyne") << "tf places it in odom";
    EXPECT_EQ(stamps.count(cloud->header.stamp), 1u);
    EXPECT_TRUE(shown.isZero() || (cloud->header.stamp - shown).toSec() > 1.0 - 1e-6);
    shown = cloud->header.stamp;
  }
}

}  // namespace
}  // namespace fail_aware::display_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "display_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
