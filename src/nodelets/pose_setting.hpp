// set_pose: where base_link is in odom, said from outside. Taken with the next estimate, moved there from its own stamp
// by the vehicle's motion (a stamp of 0: as if said of that estimate).
// Covariance: all zero means known exactly. Refused, with a reason: another frame, no pose, no covariance (or one that is
// zero for the rotation only), a stamp more than a second away from the last sweep's, or from the estimate that it is to
// be taken with.
#pragma once

#include <geometry_msgs/PoseWithCovarianceStamped.h>

#include <cmath>
#include <optional>
#include <string>

#include "fail_aware_lidar_odometry/bridge/frame_name.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"
#include "fail_aware_lidar_odometry/core/fusion/external_pose.hpp"
#include "fail_aware_lidar_odometry/core/fusion/odometry_covariance.hpp"
#include "fail_aware_lidar_odometry/core/types/filter_state.hpp"
#include "stamps.hpp"

namespace fail_aware {

class PoseSetting {
 public:
  struct AtEstimate {
    Pose T_odom_cog = Pose::Identity();
    Matrix6d covariance = Matrix6d::Zero();  ///< geometry/pose.hpp's convention
  };

  /// Why it is refused; empty: it waits for the next estimate. `last_stamp`: of the last sweep; zero: none yet.
  std::string offer(const geometry_msgs::PoseWithCovarianceStamped& message, const std::string& odom_frame,
                    const ros::Time& last_stamp) {
    const std::string frame = withoutSlash(message.header.frame_id);
    if (frame != withoutSlash(odom_frame)) return "its frame is '" + frame + "', it must be " + odom_frame;
    const std::optional<Pose> T_odom_base = fromMessage(message.pose.pose);
    if (!T_odom_base) return "the pose is none (orientation must be a unit quaternion)";
    ExternalPose pose;
    pose.stamp_s = message.header.stamp.toSec();
    pose.T_odom_base = *T_odom_base;
    pose.covariance = fromMessage(message.pose.covariance);
    ExternalPose judged = pose;
    if (judged.covariance.isZero(0.0)) judged.covariance.setIdentity();  // that one may be zero
    std::string reason = unusableReason(judged);
    if (!reason.empty()) return reason;
    if (!rotationMeasured(judged.covariance)) {
      return "its covariance is zero for the rotation only: that says nothing of the heading, which is set, too";
    }
    if (!last_stamp.isZero() && isTooFar(pose, last_stamp.toSec())) return kTooFar;
    pending_ = pose;
    return "";
  }

  bool pending() const { return pending_.has_value(); }
  void clear() { pending_.reset(); }

  /// Why what was offered cannot be taken with this estimate (it is forgotten then); empty: it can.
  std::string outdated(const FilterState& state) {
    if (!isTooFar(*pending_, state.stamp_s)) return "";
    pending_.reset();
    return kTooFar;
  }

  /// What was offered, at this estimate; it is used up.
  AtEstimate take(const FilterState& state, const Pose& T_base_cog) {
    Pose T_then_now = Pose::Identity();
    const std::optional<Vector6d> twist_cog = twistFromIncrement(state.T_previous_now, state.dt_s);
    if (twist_cog && pending_->stamp_s > 0.0) T_then_now = expSe3((state.stamp_s - pending_->stamp_s) * *twist_cog);
    const Pose T_base_now = T_base_cog * T_then_now;
    AtEstimate out;
    out.T_odom_cog = orthonormalized(pending_->T_odom_base * T_base_now);
    out.covariance = covarianceAfterOffset(pending_->covariance, pending_->T_odom_base, T_base_now);
    pending_.reset();
    return out;
  }

 private:
  static constexpr double kMaxAge_s = 1.0;
  static constexpr const char* kTooFar = "its stamp is more than a second away from the sweep's";

  static bool isTooFar(const ExternalPose& pose, double sweep_s) {
    return pose.stamp_s > 0.0 && std::abs(pose.stamp_s - sweep_s) > kMaxAge_s;
  }

  std::optional<ExternalPose> pending_;
};

}  // namespace fail_aware
