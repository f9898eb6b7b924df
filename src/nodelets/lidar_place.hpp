// The lidar's mounting in base_link: given by parameter, or looked up once in tf for the frame of the first cloud. A
// missing transform is never replaced by the identity. Once the mounting is known, clouds of another frame are refused.
#pragma once

#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <memory>
#include <optional>
#include <string>

#include "core/geometry/pose.hpp"

namespace fail_aware {

class LidarPlace {
 public:
  enum class Answer { kKnown, kNoTransform, kOtherFrame };

  void useTransforms(const std::string& base_frame);
  void use(const Pose& T_base_lidar) { T_base_lidar_ = T_base_lidar; }

  /// Looks for the mounting of this cloud's lidar.
  Answer find(const std::string& cloud_frame);

  bool known() const { return T_base_lidar_.has_value(); }
  const Pose& T_base_lidar() const { return *T_base_lidar_; }
  const std::string& lidarFrame() const { return lidar_frame_; }
  /// Why the mounting is not known, and what to do: one line for the user. Empty: not looked for yet.
  const std::string& fault() const { return fault_; }

 private:
  std::string base_frame_;
  std::string lidar_frame_;
  std::string fault_;
  std::optional<Pose> T_base_lidar_;
  std::unique_ptr<tf2_ros::Buffer> buffer_;
  std::unique_ptr<tf2_ros::TransformListener> listener_;
};

}  // namespace fail_aware
