#include "bridge/constant_transforms.hpp"

#include <tf2/buffer_core.h>

#include <algorithm>
#include <cstdio>

#include "core/geometry/degree.hpp"
#include "fail_aware_lidar_odometry/bridge/frame_name.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"

namespace fail_aware {

void ConstantTransforms::add(const tf2_msgs::TFMessage& message) {
  for (const geometry_msgs::TransformStamped& transform : message.transforms) {
    const std::optional<Pose> T = fromMessage(transform.transform);
    const std::string parent = withoutSlash(transform.header.frame_id), child = withoutSlash(transform.child_frame_id);
    if (!T || child.empty() || parent.empty() || child == parent) continue;
    const auto [found, is_new] = frames_.try_emplace(child);
    Frame& frame = found->second;
    if (is_new) {
      frame.first = transform;
      frame.parent = parent;
      frame.T_parent_frame = *T;
    } else if (parent != frame.parent) {
      frame.other_parent = parent;
    } else {
      const Pose change = frame.T_parent_frame.inverse() * *T;
      frame.shift_m = std::max(frame.shift_m, change.translation().norm());
      frame.turn_rad = std::max(frame.turn_rad, Eigen::AngleAxisd(change.linear()).angle());
    }
  }
}

std::vector<std::string> ConstantTransforms::ancestors(const std::string& frame) const {
  std::vector<std::string> names = {frame};
  for (auto at = frames_.find(frame); at != frames_.end(); at = frames_.find(names.back())) {
    if (std::find(names.begin(), names.end(), at->second.parent) != names.end()) break;  // a loop
    names.push_back(at->second.parent);
  }
  return names;
}

ConstantTransforms::Result ConstantTransforms::between(const std::string& target, const std::string& source) const {
  const std::vector<std::string> from_target = ancestors(target), from_source = ancestors(source);
  const auto common =
      std::find_first_of(from_source.begin(), from_source.end(), from_target.begin(), from_target.end());
  const std::string name = target + " -> " + source;
  if (common == from_source.end()) return {std::nullopt, "/tf_static and /tf do not connect " + name};
  tf2::BufferCore chain;  // the same bits as in the live graph
  for (const std::vector<std::string>* names : {&from_target, &from_source}) {
    for (auto at = names->begin(); *at != *common; ++at) {
      const Frame& frame = frames_.at(*at);
      if (!frame.other_parent.empty()) {
        return {std::nullopt, "the transform " + name + " is not known: " + *at + " has two parents, " + frame.parent +
                                  " and " + frame.other_parent};
      }
      if (frame.shift_m > kMaxShift_m || frame.turn_rad > kMaxTurn_rad) {
        char change[80];
        std::snprintf(change, sizeof(change), "%.3g m and %.3g deg", frame.shift_m, frame.turn_rad / kDegree);
        return {std::nullopt, "the transform " + name + " is not constant: " + frame.parent + " -> " + *at +
                                  " changes by up to " + change};
      }
      chain.setTransform(frame.first, "recording", true);
    }
  }
  const std::optional<Pose> T =
      target == source ? Pose::Identity() : fromMessage(chain.lookupTransform(target, source, ros::Time(0)).transform);
  if (!T) return {std::nullopt, "the transform " + name + " is no pose"};
  return {T, {}};
}

}  // namespace fail_aware
