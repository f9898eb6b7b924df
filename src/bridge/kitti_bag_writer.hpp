// Writes a drive in the layout of kitti2bag, so that bags of recorded and of simulated drives replay alike.
//
//   /kitti/velo/pointcloud     sensor_msgs/PointCloud2: x y z i, FLOAT32, point_step 16, frame velo_link
//   /tf_static                 base_link -> velo_link, latched, once with every sweep
//   /kitti/ground_truth        nav_msgs/Odometry of base_link in world, if the ground truth is known
//   /tf                        world -> base_link, the same poses; only on request: the odometry publishes
//                              odom -> base_link, and a frame has only one parent
//
// Additions to kitti2bag: the cloud has the field `ring` (UINT16) if the sweep has rings, and optionally the field
// `time` (FLOAT32, s from the sweep's start). The transform comes half a second before the first cloud, so that a
// listener receives it in time.
// Failure: the constructor throws InputError if the file cannot be opened, add() and close() std::runtime_error if it
// cannot be written. Memory: one sweep and the bag's index.
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <optional>
#include <string>

#include "core/geometry/pose.hpp"
#include "fail_aware_lidar_odometry/bridge/bag_file.hpp"
#include "fail_aware_lidar_odometry/sweep.hpp"

namespace fail_aware {

namespace kitti_bag {
inline constexpr const char* kCloudTopic = "/kitti/velo/pointcloud";
inline constexpr const char* kGroundTruthTopic = "/kitti/ground_truth";
inline constexpr const char* kTransformTopic = "/tf";
inline constexpr const char* kStaticTransformTopic = "/tf_static";
inline constexpr const char* kLidarFrame = "velo_link";
inline constexpr const char* kBaseFrame = "base_link";
inline constexpr const char* kWorldFrame = "world";
}  // namespace kitti_bag

struct KittiBagOptions {
  Pose T_base_lidar = Pose::Identity();
  bool point_times = false;      ///< write the field `time` if the sweep has times
  bool with_transforms = false;  ///< write /tf, world -> base_link
};

/// Writes x y z i, `time` if `with_times`, and ring if the sweep has rings; the caller sets the header. A sweep without
/// points gives a cloud of width 0.
void writeKittiCloud(const Sweep& sweep, bool with_times, sensor_msgs::PointCloud2& cloud);

class KittiBagWriter {
 public:
  using Options = KittiBagOptions;

  KittiBagWriter(const std::string& path, const Options& options);

  /// Stamps must increase. Times are left out if their number is not the number of points.
  void add(const ros::Time& stamp, const Sweep& sweep, const std::optional<Pose>& T_world_base = std::nullopt);
  void close() { bag_.close(); }

 private:
  void addStaticTransform(const ros::Time& stamp);
  void addGroundTruth(const ros::Time& stamp, const Pose& T_world_base);

  Options options_;
  BagFile bag_;
  bool begun_ = false;
};

}  // namespace fail_aware
