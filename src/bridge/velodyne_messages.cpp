#include "bridge/velodyne_messages.hpp"

#include <cmath>
#include <cstring>

#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"

namespace fail_aware {

ros::Time timeAt(const ros::Time& epoch, double seconds) {
  return epoch + ros::Duration().fromNSec(std::llround(seconds * 1e6) * 1000);
}

void writeVelodyneCloud(const Sweep& sweep, sensor_msgs::PointCloud2& cloud) {
  using sensor_msgs::PointField;
  struct Layout {
    const char* name;
    std::uint32_t offset;
    std::uint8_t type;
  };
  static constexpr Layout kLayout[] = {{"x", 0, PointField::FLOAT32},    {"y", 4, PointField::FLOAT32},
                                       {"z", 8, PointField::FLOAT32},    {"intensity", 12, PointField::FLOAT32},
                                       {"ring", 16, PointField::UINT16}, {"time", 18, PointField::FLOAT32}};
  constexpr std::uint32_t kPointStep = 22;
  cloud.fields.clear();
  for (const Layout& layout : kLayout) {
    PointField field;
    field.name = layout.name;
    field.offset = layout.offset;
    field.datatype = layout.type;
    field.count = 1;
    cloud.fields.push_back(field);
  }
  const std::size_t count = sweep.size();
  cloud.is_bigendian = false;
  cloud.is_dense = true;
  cloud.height = 1;
  cloud.width = static_cast<std::uint32_t>(count);
  cloud.point_step = kPointStep;
  cloud.row_step = cloud.width * kPointStep;
  cloud.data.resize(cloud.row_step);
  const bool has_intensity = sweep.intensities.size() == count, has_ring = sweep.rings.size() == count;
  const bool has_time = sweep.times_s.size() == count;
  std::uint8_t* out = cloud.data.data();
  for (std::size_t i = 0; i < count; ++i, out += kPointStep) {
    const Eigen::Vector3f& p = sweep.points_lidar[i];
    const float values[4] = {p.x(), p.y(), p.z(), has_intensity ? sweep.intensities[i] : 0.0f};
    const std::uint16_t ring = has_ring ? sweep.rings[i] : std::uint16_t{0};
    const float time_s = has_time ? sweep.times_s[i] : 0.0f;
    if (!p.allFinite()) cloud.is_dense = false;
    std::memcpy(out, values, sizeof values);
    std::memcpy(out + 16, &ring, sizeof ring);
    std::memcpy(out + 18, &time_s, sizeof time_s);
  }
}

geometry_msgs::TransformStamped lidarPlace(const Pose& T_base_lidar, const VelodyneNames& names,
                                           const ros::Time& stamp) {
  geometry_msgs::TransformStamped place;
  place.header.stamp = stamp;
  place.header.frame_id = names.base_frame;
  place.child_frame_id = names.lidar_frame;
  place.transform = toTransformMessage(T_base_lidar);
  return place;
}

nav_msgs::Odometry groundTruth(const Pose& T_truth_base, const VelodyneNames& names, const ros::Time& stamp) {
  nav_msgs::Odometry odometry;
  odometry.header.stamp = stamp;
  odometry.header.frame_id = names.ground_truth_frame;
  odometry.child_frame_id = names.base_frame;
  odometry.pose.pose = toPoseMessage(T_truth_base);
  return odometry;
}

}  // namespace fail_aware
