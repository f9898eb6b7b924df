// Drives the live graph along the made-up street, one sweep after the other: each is published when the one before has
// its filter state, odometry and (where there is a monitor) time to failure.
#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <nodelet/NodeletLoad.h>
#include <nodelet/NodeletUnload.h>
#include <ros/ros.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <map>
#include <string>
#include <vector>

#include "bus_links.hpp"
#include "fail_aware_lidar_odometry/bridge/graph_message_conversion.hpp"
#include "fail_aware_lidar_odometry/bridge/point_cloud_conversion.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"
#include "graph_recorder.hpp"
#include "synthetic_street.hpp"

namespace fail_aware {

inline constexpr double kSweepPeriod_s = 0.1;
inline constexpr const char* kCloudTopic = "/lidar/points";

inline ros::Time stampOfSweep(int i) { return ros::Time(1317384506, 0) + ros::Duration(kSweepPeriod_s * i); }

/// As it comes from the head; the same number gives the same points.
inline Sweep streetSweep(int i) {
  static const synthetic::Street street;
  static std::map<int, Sweep> scanned;
  const auto at = scanned.find(i);
  if (at != scanned.end()) return at->second;
  const synthetic::Drive drive;
  return scanned[i] = street.scan([&](double t) { return drive.T_street_base(t); }, kSweepPeriod_s * i,
                                  static_cast<std::uint32_t>(i));
}

/// x y z intensity time ring, the time zero everywhere, as the driver's for a 64E.
inline sensor_msgs::PointCloud2Ptr cloudOf(const Sweep& sweep, const ros::Time& stamp) {
  const auto cloud = boost::make_shared<sensor_msgs::PointCloud2>();
  CorrectedSweep points;
  points.points_lidar = sweep.points_lidar;
  points.rings = sweep.rings;
  writeCloud(points, sweep.intensities, *cloud);
  cloud->header.frame_id = "velodyne";
  cloud->header.stamp = stamp;
  return cloud;
}

inline sensor_msgs::PointCloud2Ptr streetCloud(int i) { return cloudOf(streetSweep(i), stampOfSweep(i)); }

inline bool has(std::uint32_t reasons, std::uint32_t bits) { return (reasons & bits) == bits; }

struct VehicleNames {
  std::string cloud_topic = kCloudTopic;
  std::string frame_prefix;  ///< of base_link and velodyne
};

class GraphDriver {
 public:
  explicit GraphDriver(const std::string& graph_namespace = "/fail_aware_lidar_odometry",
                       const VehicleNames& names = {})
      : names_(names),
        node_(graph_namespace),
        states(node_, "filter_state"),
        odometry(node_, "odometry"),
        times(node_, "time_to_failure"),
        publisher_(node_.advertise<sensor_msgs::PointCloud2>(names.cloud_topic, 10)) {}

  ros::NodeHandle& node() { return node_; }
  std::string topic(const std::string& name) const { return node_.resolveName(name); }

  void sendTransform(const Pose& T_base_lidar = synthetic::Lidar().T_base_lidar) {
    geometry_msgs::TransformStamped transform;
    transform.header.frame_id = names_.frame_prefix + "base_link";
    transform.child_frame_id = names_.frame_prefix + "velodyne";
    transform.transform = toTransformMessage(T_base_lidar);
    broadcaster_.sendTransform(transform);
  }

  /// The whole graph is up, each stage linked with its neighbours.
  bool waitUntilLinked() {
    std::vector<std::string> topics = {names_.cloud_topic};
    for (const char* name :
         {"sweep/prediction", "sweep/points", "sweep/check", "filter_state", "odometry", "time_to_failure",
          "measurement/icp_point_to_point", "measurement/icp_point_to_plane", "measurement/corner_svd"}) {
      topics.push_back(topic(name));
    }
    return waitFor([&] {
      ros::WallDuration(0.05).sleep();
      return allLinked(topics);
    });
  }

  /// The first cloud; it waits in the graph until tf is there.
  bool start(const sensor_msgs::PointCloud2Ptr& cloud) {
    publisher_.publish(cloud);
    return waitFor([&] { return answered(cloud->header.stamp); });
  }

  /// False: it has no estimate within patience.
  bool drive(const sensor_msgs::PointCloud2Ptr& cloud, double patience_s = kPatience_s) {
    const ros::Time stamp = cloud->header.stamp;
    states.forget(stamp);
    odometry.forget(stamp);
    times.forget(stamp);
    const ros::SteadyTime begin = ros::SteadyTime::now();
    publisher_.publish(cloud);
    const bool came = waitFor([&] { return answered(stamp); }, patience_s);
    answer_s = (ros::SteadyTime::now() - begin).toSec();
    return came;
  }

  void publish(const sensor_msgs::PointCloud2Ptr& cloud) { publisher_.publish(cloud); }

  bool answered(const ros::Time& stamp) const {
    return states.count(stamp) > 0 && odometry.count(stamp) > 0 && (!monitored || times.count(stamp) > 0);
  }

  Pose T_odom_base(const ros::Time& stamp) const {
    return fromMessage(odometry.at(stamp).pose.pose).value_or(Pose::Identity());
  }

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

  static const std::map<std::string, std::string>& types() {
    static const std::map<std::string, std::string> types = {{"sweep_correction", "SweepCorrection"},
                                                             {"icp_point_to_point", "IcpPointToPoint"},
                                                             {"icp_point_to_plane", "IcpPointToPlane"},
                                                             {"corner_svd", "CornerSvd"},
                                                             {"fusion_ukf", "FusionUkf"},
                                                             {"fail_aware_monitor", "FailAwareMonitor"}};
    return types;
  }

  bool load(const std::string& name) {
    nodelet::NodeletLoad call;
    call.request.name = namespace_ + '/' + name;
    call.request.type = "fail_aware_lidar_odometry/" + types().at(name);
    call.request.remap_source_args = {namespace_ + "/points"};
    call.request.remap_target_args = {kCloudTopic};
    const std::string service = namespace_ + "/manager/load_nodelet";
    return ros::service::waitForService(service, ros::Duration(kPatience_s)) && ros::service::call(service, call) &&
           call.response.success;
  }

  bool unload(const std::string& name) {
    nodelet::NodeletUnload call;
    call.request.name = namespace_ + '/' + name;
    return ros::service::call(namespace_ + "/manager/unload_nodelet", call) && call.response.success;
  }

 private:
  std::string namespace_;
};

}  // namespace fail_aware
