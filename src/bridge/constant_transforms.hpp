// The constant transforms of a recording: sensor mountings from /tf_static or, as ROS 1's static_transform_publisher
// sends them, from /tf.
//
// add() takes every message of the recording. between() chains the transforms from one frame to another. Frames on the
// chain must not move; others (odom -> base_link) may. A frame moves if its parent changes or if a transform differs
// from the frame's first one by more than kMaxShift_m or kMaxTurn_rad. The first transform is used. Transforms that are
// not finite or not a rotation are ignored. Cost: a map look-up per transform; memory: one transform per frame.
#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <tf2_msgs/TFMessage.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pose.hpp"

namespace fail_aware {

class ConstantTransforms {
 public:
  static constexpr double kMaxShift_m = 1e-3;
  static constexpr double kMaxTurn_rad = 5e-4;

  struct Result {
    std::optional<Pose> T_target_source;
    std::string why_not;  ///< if there is no transform: what is missing or what moves
  };

  void add(const tf2_msgs::TFMessage& message);

  /// Frames without a leading slash.
  Result between(const std::string& target, const std::string& source) const;

 private:
  struct Frame {
    geometry_msgs::TransformStamped first;
    std::string parent;
    Pose T_parent_frame = Pose::Identity();
    double shift_m = 0.0, turn_rad = 0.0;  ///< largest difference from the first transform
    std::string other_parent;              ///< empty: the parent never changed
  };

  /// From the frame up to the root, including the frame itself.
  std::vector<std::string> ancestors(const std::string& frame) const;

  std::map<std::string, Frame> frames_;
};

}  // namespace fail_aware
