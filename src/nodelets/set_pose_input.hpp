// set_pose in FusionUkf: a pose of base_link in odom (m, rad) that is set from outside. It waits in the estimator for
// the next sweep's update.
// Failure: a refused pose (another frame, no unit quaternion, the estimator's reasons) changes nothing. Refused poses
// and poses that were set appear in the log and in the diagnostics.
#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <ros/ros.h>

#include <cstddef>
#include <optional>
#include <string>

#include "core/estimator.hpp"
#include "pose_message.hpp"
#include "topics.hpp"

namespace fail_aware {

class SetPoseInput {
 public:
  /// Subscribes. `estimator` must outlive this object. `log_name`: the nodelet's name.
  SetPoseInput(ros::NodeHandle& node, const std::string& log_name, const std::string& odom_frame,
               const Pose& T_base_cog, Estimator& estimator)
      : log_name_(log_name), odom_frame_(odom_frame), T_cog_base_(T_base_cog.inverse()), estimator_(estimator) {
    subscriber_ = node.subscribe(topics::kSetPose, 1, &SetPoseInput::onPose, this);
  }

  /// Reports the outcome of the waiting pose; call it after the estimator's update or reset.
  void report() {
    const PoseSet outcome = estimator_.takePoseSet();
    refuse(outcome.refused);
    if (!outcome.done) return;
    ++set_;
    const Eigen::Vector3d position = (estimator_.state().T_odom_cog * T_cog_base_).translation();
    ROS_INFO_NAMED(log_name_, "pose set to x %.3f y %.3f z %.3f m", position.x(), position.y(), position.z());
  }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const {
    status.add("poses set", set_);
    status.add("poses refused (set_pose)", refused_);
  }

 private:
  void onPose(const geometry_msgs::PoseWithCovarianceStampedConstPtr& message) {
    std::string reason;
    const std::optional<ExternalPose> pose = poseInOdom(*message, odom_frame_, reason);
    refuse(pose ? estimator_.setPose(*pose) : reason);
  }

  void refuse(const std::string& reason) {
    if (reason.empty()) return;
    ++refused_;
    ROS_WARN_NAMED(log_name_, "set_pose refused: %s", reason.c_str());
  }

  std::string log_name_;
  std::string odom_frame_;
  Pose T_cog_base_;
  Estimator& estimator_;
  std::size_t set_ = 0, refused_ = 0;
  ros::Subscriber subscriber_;  // has callbacks: must be destroyed first
};

}  // namespace fail_aware
