// The transforms of a recording that do not change: where a sensor sits, from /tf_static or, as ROS 1's
// static_transform_publisher does it, from /tf.
//
// add() takes every message of the recording. between() chains the transforms from one frame to another one; frames that
// move elsewhere (odom -> base_link) do not matter, those on the chain must not move: a frame moves if its parent changes
// or if a transform is more than kMaxShift_m or kMaxTurn_rad from its first one. The first ones count. Transforms that are
// not finite or not a rotation are left out. Cost: a map look-up per transform; memory: one transform per frame.
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
    std::string why_not;  ///< where there is none: what is missing or what moves
  };

  void add(const tf2_msgs::TFMessage& message);

  /// Frames without a leading slash.
  Result between(const std::string& target, const std::string& source) const;

 private:
  struct Frame {
    geometry_msgs::TransformStamped first;
    std::string parent;
    Pose T_parent_frame = Pose::Identity();
    double shift_m = 0.0, turn_rad = 0.0;  ///< the most, from the first one
    std::string other_parent;              ///< empty: it has one only
  };

  /// From the frame up to the root, the frame itself included.
  std::vector<std::string> ancestors(const std::string& frame) const;

  std::map<std::string, Frame> frames_;
};

}  // namespace fail_aware
