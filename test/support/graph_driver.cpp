#include "graph_driver.hpp"

#include <geometry_msgs/TransformStamped.h>
#include <nodelet/NodeletLoad.h>
#include <nodelet/NodeletUnload.h>

#include <boost/make_shared.hpp>
#include <vector>

#include "bus_links.hpp"
#include "core/types/corrected_sweep.hpp"
#include "fail_aware_lidar_odometry/bridge/point_cloud_conversion.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"

namespace fail_aware {

template class Recorder<messages::FilterState>;
template class Recorder<nav_msgs::Odometry>;
template class Recorder<messages::TimeToFailure>;

ros::Time stampOfSweep(int i) { return ros::Time(1317384506, 0) + ros::Duration(kSweepPeriod_s * i); }

Sweep streetSweep(int i) {
  static const synthetic::Street street;
  static std::map<int, Sweep> scanned;
  const auto at = scanned.find(i);
  if (at != scanned.end()) return at->second;
  const synthetic::Drive drive;
  return scanned[i] = street.scan([&](double t) { return drive.T_street_base(t); }, kSweepPeriod_s * i,
                                  static_cast<std::uint32_t>(i));
}

sensor_msgs::PointCloud2Ptr cloudOf(const Sweep& sweep, const ros::Time& stamp) {
  const auto cloud = boost::make_shared<sensor_msgs::PointCloud2>();
  CorrectedSweep points;
  points.points_lidar = sweep.points_lidar;
  points.rings = sweep.rings;
  writeCloud(points, sweep.intensities, *cloud);
  cloud->header.frame_id = "velodyne";
  cloud->header.stamp = stamp;
  return cloud;
}

sensor_msgs::PointCloud2Ptr streetCloud(int i) { return cloudOf(streetSweep(i), stampOfSweep(i)); }

GraphDriver::GraphDriver(const std::string& graph_namespace, const VehicleNames& names)
    : names_(names),
      node_(graph_namespace),
      states(node_, "filter_state"),
      odometry(node_, "odometry"),
      times(node_, "time_to_failure"),
      publisher_(node_.advertise<sensor_msgs::PointCloud2>(names.cloud_topic, 10)) {}

GraphDriver::~GraphDriver() = default;

void GraphDriver::sendTransform(const Pose& T_base_lidar) {
  geometry_msgs::TransformStamped transform;
  transform.header.frame_id = names_.frame_prefix + "base_link";
  transform.child_frame_id = names_.frame_prefix + "velodyne";
  transform.transform = toTransformMessage(T_base_lidar);
  broadcaster_.sendTransform(transform);
}

bool GraphDriver::waitUntilLinked() {
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

bool GraphDriver::start(const sensor_msgs::PointCloud2Ptr& cloud) {
  publisher_.publish(cloud);
  return waitFor([&] { return answered(cloud->header.stamp); });
}

bool GraphDriver::drive(const sensor_msgs::PointCloud2Ptr& cloud, double patience_s) {
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

void GraphDriver::publish(const sensor_msgs::PointCloud2Ptr& cloud) { publisher_.publish(cloud); }

bool GraphDriver::answered(const ros::Time& stamp) const {
  return states.count(stamp) > 0 && odometry.count(stamp) > 0 && (!monitored || times.count(stamp) > 0);
}

Pose GraphDriver::T_odom_base(const ros::Time& stamp) const {
  return fromMessage(odometry.at(stamp).pose.pose).value_or(Pose::Identity());
}

const std::map<std::string, std::string>& NodeletManager::types() {
  static const std::map<std::string, std::string> types = {{"sweep_correction", "SweepCorrection"},
                                                           {"icp_point_to_point", "IcpPointToPoint"},
                                                           {"icp_point_to_plane", "IcpPointToPlane"},
                                                           {"corner_svd", "CornerSvd"},
                                                           {"fusion_ukf", "FusionUkf"},
                                                           {"fail_aware_monitor", "FailAwareMonitor"}};
  return types;
}

bool NodeletManager::load(const std::string& name) {
  nodelet::NodeletLoad call;
  call.request.name = namespace_ + '/' + name;
  call.request.type = "fail_aware_lidar_odometry/" + types().at(name);
  call.request.remap_source_args = {namespace_ + "/points"};
  call.request.remap_target_args = {kCloudTopic};
  const std::string service = namespace_ + "/manager/load_nodelet";
  return ros::service::waitForService(service, ros::Duration(kPatience_s)) && ros::service::call(service, call) &&
         call.response.success;
}

bool NodeletManager::unload(const std::string& name) {
  nodelet::NodeletUnload call;
  call.request.name = namespace_ + '/' + name;
  return ros::service::call(namespace_ + "/manager/unload_nodelet", call) && call.response.success;
}

}  // namespace fail_aware
