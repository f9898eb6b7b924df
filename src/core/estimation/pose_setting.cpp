#include "core/estimation/pose_setting.hpp"

#include <cmath>

#include "core/estimation/increment_covariance.hpp"

namespace fail_aware {

namespace {

constexpr double kMaxAge_s = 1.0;
constexpr const char* kTooFar = "its stamp is more than a second away from the sweep's";

bool isTooFar(const std::optional<double>& stamp_s, double sweep_s) {
  return stamp_s && std::abs(*stamp_s - sweep_s) > kMaxAge_s;
}

}  // namespace

std::string PoseSetting::offer(const ExternalPose& pose, std::optional<double> last_stamp_s) {
  ExternalPose judged = pose;
  if (judged.covariance.isZero(0.0)) judged.covariance.setIdentity();  // zero is allowed: the pose is exact
  std::string reason = unusableReason(judged);
  if (!reason.empty()) return reason;
  if (!rotationMeasured(judged.covariance)) {
    return "its covariance is zero for the rotation only: that says nothing of the heading, which is set, too";
  }
  const std::optional<double> stamp_s = pose.stamp_s > 0.0 ? std::optional<double>(pose.stamp_s) : std::nullopt;
  if (last_stamp_s && isTooFar(stamp_s, *last_stamp_s)) return kTooFar;
  pending_ = pose;
  stamp_s_ = stamp_s;
  return "";
}

bool PoseSetting::isAt(const FilterState& state) const {
  constexpr double kSame_s = 0.02;
  return !stamp_s_ || std::abs(*stamp_s_ - state.stamp_s) <= kSame_s;
}

std::string PoseSetting::outdated(const FilterState& state) {
  if (!isTooFar(stamp_s_, state.stamp_s)) return "";
  pending_.reset();
  return kTooFar;
}

PoseSetting::AtEstimate PoseSetting::take(const FilterState& state, const Pose& T_base_cog) {
  Pose T_then_now = Pose::Identity();
  const std::optional<Vector6d> twist_cog = twistFromIncrement(state.T_previous_now, state.dt_s);
  if (twist_cog && stamp_s_) T_then_now = expSe3((state.stamp_s - *stamp_s_) * *twist_cog);
  const Pose T_base_now = T_base_cog * T_then_now;
  AtEstimate out;
  out.T_odom_cog = orthonormalized(pending_->T_odom_base * T_base_now);
  out.covariance = covarianceAfterOffset(pending_->covariance, pending_->T_odom_base, T_base_now);
  pending_.reset();
  return out;
}

}  // namespace fail_aware
