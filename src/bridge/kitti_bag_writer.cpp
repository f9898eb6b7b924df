#include "bridge/kitti_bag_writer.hpp"

#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <tf2_msgs/TFMessage.h>

#include <cstring>

#include "cloud_layout.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"

namespace fail_aware {

namespace {

const ros::Duration kTransformLead(0.5);

geometry_msgs::TransformStamped stamped(const ros::Time& stamp, const char* parent, const char* child, const Pose& T) {
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = stamp;
  transform.header.frame_id = parent;
  transform.child_frame_id = child;
  transform.transform = toTransformMessage(T);
  return transform;
}

}  // namespace

void writeKittiCloud(const Sweep& sweep, bool with_times, sensor_msgs::PointCloud2& cloud) {
  const std::size_t count = sweep.size();
  const bool has_intensity = sweep.intensities.size() == count, has_ring = sweep.rings.size() == count;
  const bool has_time = with_times && sweep.times_s.size() == count;
  if (has_time) {
    layOut({"x", "y", "z", "i", "time"}, has_ring, count, cloud);
  } else {
    layOut({"x", "y", "z", "i"}, has_ring, count, cloud);
  }
  const std::size_t floats = sizeof(float) * (has_time ? 5 : 4);
  std::uint8_t* out = cloud.data.data();
  for (std::size_t i = 0; i < count; ++i, out += cloud.point_step) {
    const Eigen::Vector3f& p = sweep.points_lidar[i];
    const float values[] = {p.x(), p.y(), p.z(), has_intensity ? sweep.intensities[i] : 0.0f,
                            has_time ? sweep.times_s[i] : 0.0f};
    std::memcpy(out, values, floats);
    if (has_ring) std::memcpy(out + floats, &sweep.rings[i], sizeof(std::uint16_t));
  }
}

KittiBagWriter::KittiBagWriter(const std::string& path, const Options& options) : options_(options), bag_(path) {}

void KittiBagWriter::add(const ros::Time& stamp, const Sweep& sweep, const std::optional<Pose>& T_world_base) {
  if (!begun_) addStaticTransform(stamp.toSec() > 1.0 ? stamp - kTransformLead : ros::TIME_MIN);
  begun_ = true;
  addStaticTransform(stamp);
  if (T_world_base) addGroundTruth(stamp, *T_world_base);
  sensor_msgs::PointCloud2 cloud;
  writeKittiCloud(sweep, options_.point_times, cloud);
  cloud.header.stamp = stamp;
  cloud.header.frame_id = kitti_bag::kLidarFrame;
  bag_.write(kitti_bag::kCloudTopic, stamp, cloud);
}

void KittiBagWriter::addStaticTransform(const ros::Time& stamp) {
  tf2_msgs::TFMessage message;
  message.transforms.push_back(stamped(stamp, kitti_bag::kBaseFrame, kitti_bag::kLidarFrame, options_.T_base_lidar));
  bag_.writeLatched(kitti_bag::kStaticTransformTopic, stamp, message, "/kitti_to_bag");
}

void KittiBagWriter::addGroundTruth(const ros::Time& stamp, const Pose& T_world_base) {
  nav_msgs::Odometry odometry;
  odometry.header.stamp = stamp;
  odometry.header.frame_id = kitti_bag::kWorldFrame;
  odometry.child_frame_id = kitti_bag::kBaseFrame;
  odometry.pose.pose = toPoseMessage(T_world_base);
  bag_.write(kitti_bag::kGroundTruthTopic, stamp, odometry);
  if (!options_.with_transforms) return;
  tf2_msgs::TFMessage message;
  message.transforms.push_back(stamped(stamp, kitti_bag::kWorldFrame, kitti_bag::kBaseFrame, T_world_base));
  bag_.write(kitti_bag::kTransformTopic, stamp, message);
}

}  // namespace fail_aware
