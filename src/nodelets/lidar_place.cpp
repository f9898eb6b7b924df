#include "lidar_place.hpp"

#include "fail_aware_lidar_odometry/bridge/frame_name.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"

namespace fail_aware {

void LidarPlace::useTransforms(const std::string& base_frame) {
  base_frame_ = withoutSlash(base_frame);
  buffer_ = std::make_unique<tf2_ros::Buffer>();
  listener_ = std::make_unique<tf2_ros::TransformListener>(*buffer_);
}

LidarPlace::Answer LidarPlace::find(const std::string& cloud_frame) {
  const std::string frame = withoutSlash(cloud_frame);
  if (T_base_lidar_) {
    if (lidar_frame_.empty()) lidar_frame_ = frame;
    return frame == lidar_frame_ ? Answer::kKnown : Answer::kOtherFrame;
  }
  lidar_frame_ = frame;
  if (frame == base_frame_) {
    T_base_lidar_ = Pose::Identity();
  } else {
    try {
      T_base_lidar_ = fromMessage(buffer_->lookupTransform(base_frame_, frame, ros::Time(0)).transform);
      if (!T_base_lidar_) error_ = "the transform's numbers are no pose";
      // by way of the parameter's six numbers, as offline: the same to the last bit
      if (T_base_lidar_) T_base_lidar_ = poseFromVector(vectorFromPose(*T_base_lidar_));
    } catch (const tf2::TransformException& error) {
      error_ = error.what();
    }
  }
  if (!T_base_lidar_) return Answer::kNoTransform;
  listener_.reset();
  return Answer::kKnown;
}

}  // namespace fail_aware
