#include "lidar_place.hpp"

#include <vector>

#include "core/parameters/check.hpp"
#include "core/parameters/mounting.hpp"
#include "fail_aware_lidar_odometry/bridge/frame_name.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"

namespace fail_aware {

namespace {

/// tf's messages end in one or several full stops.
std::string withoutStop(std::string text) {
  while (!text.empty() && (text.back() == '.' || text.back() == ' ')) text.pop_back();
  return text;
}

Pose asMounting(const std::optional<Pose>& T) {
  if (!T) throw ParameterError("the transform is not a valid pose");
  const Vector6d place = vectorFromPose(*T);
  const std::vector<double> numbers(place.data(), place.data() + place.size());
  requireMounting("the transform in m and rad", numbers);
  return mountingPose(numbers);
}

}  // namespace

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
  const std::string what = "no transform " + base_frame_ + " -> " + frame + ": ";
  if (frame.empty()) {
    fault_ = "the clouds have no frame_id: set the driver's, to a frame that tf places in " + base_frame_;
  } else if (frame == base_frame_) {
    T_base_lidar_ = Pose::Identity();
  } else {
    try {
      // through the parameter's six numbers, as offline: the same bits
      T_base_lidar_ = asMounting(fromMessage(buffer_->lookupTransform(base_frame_, frame, ros::Time(0)).transform));
    } catch (const tf2::TransformException& error) {
      fault_ = what + withoutStop(error.what()) +
               "; publish it (static_transform_publisher, robot description), or set lidar_in_base in the sensor file "
               "and lidar_in_base_source to parameter";
    } catch (const ParameterError& error) {
      fault_ = what + error.what();
    }
  }
  if (!T_base_lidar_) return Answer::kNoTransform;
  listener_.reset();
  return Answer::kKnown;
}

}  // namespace fail_aware
