// Drives the live graph along the made-up street, one sweep after the other: each is published when the one before has
// its filter state, odometry and (where there is a monitor) time to failure.
#pragma once

#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <cstdint>
#include <map>
#include <string>

#include "bridge/graph_message_conversion.hpp"
#include "bridge/monitor_message_conversion.hpp"
#include "graph_recorder.hpp"
#include "synthetic_street.hpp"

namespace fail_aware {

inline constexpr double kSweepPeriod_s = 0.1;
inline constexpr const char* kCloudTopic = "/lidar/points";

ros::Time stampOfSweep(int i);

/// As it comes from the head; the same number gives the same points.
Sweep streetSweep(int i);

/// x y z intensity time ring, the time zero everywhere, as the driver's for a 64E.
sensor_msgs::PointCloud2Ptr cloudOf(const Sweep& sweep, const ros::Time& stamp);

sensor_msgs::PointCloud2Ptr streetCloud(int i);

inline bool has(std::uint32_t reasons, std::uint32_t bits) { return (reasons & bits) == bits; }

extern template class Recorder<messages::FilterState>;
extern template class Recorder<nav_msgs::Odometry>;
extern template class Recorder<messages::TimeToFailure>;

struct VehicleNames {
  std::string cloud_topic = kCloudTopic;
  std::string frame_prefix;  ///< of base_link and velodyne
};

class GraphDriver {
 public:
  explicit GraphDriver(const std::string& graph_namespace = "/fail_aware_lidar_odometry",
                       const VehicleNames& names = {});
  ~GraphDriver();

  ros::NodeHandle& node() { return node_; }
  std::string topic(const std::string& name) const { return node_.resolveName(name); }

  void sendTransform(const Pose& T_base_lidar = synthetic::Lidar().T_base_lidar);

  /// The whole graph is up, each stage linked with its neighbours.
  bool waitUntilLinked();

  /// The first cloud; it waits in the graph until tf is there.
  bool start(const sensor_msgs::PointCloud2Ptr& cloud);

  /// False: it has no estimate within patience.
  bool drive(const sensor_msgs::PointCloud2Ptr& cloud, double patience_s = kPatience_s);

  void publish(const sensor_msgs::PointCloud2Ptr& cloud);
  bool answered(const ros::Time& stamp) const;
  Pose T_odom_base(const ros::Time& stamp) const;

 private:
  VehicleNames names_;
  ros::NodeHandle node_;

 public:
  Recorder<messages::FilterState> states;
  Recorder<nav_msgs::Odometry> odometry;
  Recorder<messages::TimeToFailure> times;
  bool monitored = true;  ///< wait for time_to_failure, too
  double answer_s = 0.0;  ///< of the last drive(), by the steady clock

 private:
  ros::Publisher publisher_;
  tf2_ros::StaticTransformBroadcaster broadcaster_;
};

/// The nodelets of a manager, by hand.
class NodeletManager {
 public:
  explicit NodeletManager(const std::string& graph_namespace = "/fail_aware_lidar_odometry")
      : namespace_(graph_namespace) {}

  static const std::map<std::string, std::string>& types();
  bool load(const std::string& name);
  bool unload(const std::string& name);

 private:
  std::string namespace_;
};

}  // namespace fail_aware
