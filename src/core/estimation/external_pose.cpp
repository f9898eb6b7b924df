#include "core/estimation/external_pose.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "core/estimation/increment_covariance.hpp"
#include "core/estimation/largest_values.hpp"
#include "core/geometry/decompositions.hpp"

namespace fail_aware {

namespace {

constexpr double kSpeedSigma = 0.1;  // of the motion between two stamps: relative to its length

}  // namespace

bool rotationMeasured(const Matrix6d& covariance) { return !covariance.bottomRightCorner<3, 3>().isZero(0.0); }

std::string unusableReason(const ExternalPose& pose) {
  if (!std::isfinite(pose.stamp_s) || !isFinite(pose.T_odom_base)) return "the pose is not finite";
  if (pose.T_odom_base.translation().cwiseAbs().maxCoeff() > kFarthestPose_m) return "the position is beyond 1e9 m";
  return unusableReason(pose.covariance);
}

std::string unusableReason(const Matrix6d& C) {
  if (!C.allFinite()) return "the covariance is not finite";
  const double scale = C.cwiseAbs().maxCoeff();
  if (scale > kLargestVariance) return "the covariance is above 1e12: that is no measurement";
  if (scale == 0.0) return "the covariance is all zero: it must say how good the pose is";
  if (!(C - C.transpose()).isZero(1e-6 * scale)) return "the covariance is not symmetric";
  const Eigen::Matrix3d position = C.topLeftCorner<3, 3>();
  if (!(symmetricEigen(position).eigenvalues()[0] > 0.0)) {
    return "the position's covariance is not positive";
  }
  if (!rotationMeasured(C)) return "";
  if (!(symmetricEigenvalues(C)[0] > 0.0)) return "the covariance is not positive";
  return "";
}

Measurement externalMeasurement(const ExternalPose& pose, double stamp_s, const Pose& T_odom_cog_predicted,
                                const Vector6d& twist_cog, const Pose& T_base_cog) {
  const Vector6d motion = (stamp_s - pose.stamp_s) * twist_cog;
  const Pose T_then_now = expSe3(motion);
  const bool rotation_measured = rotationMeasured(pose.covariance);
  Pose T_odom_base = pose.T_odom_base;
  if (!rotation_measured) {
    T_odom_base.linear() = (T_odom_cog_predicted * T_then_now.inverse() * T_base_cog.inverse()).linear();
  }
  const Pose T_base_now = T_base_cog * T_then_now;
  Measurement measurement;
  measurement.status = MeasurementStatus::kOk;
  measurement.T_odom_cog = T_odom_base * T_base_now;
  measurement.covariance = pose.covariance;
  if (rotation_measured) {
    measurement.covariance = covarianceAfterOffset(pose.covariance, T_odom_base, T_base_now);
    const double sigma_rad = kSpeedSigma * motion.tail<3>().norm();
    measurement.covariance.diagonal().tail<3>().array() += sigma_rad * sigma_rad;
  } else {
    measurement.covariance.rightCols<3>().setZero();
    measurement.covariance.bottomRows<3>().setZero();
    measurement.covariance.diagonal().tail<3>().setConstant(kUnobservedVariance);
  }
  const double sigma_m = kSpeedSigma * motion.head<3>().norm();
  measurement.covariance.diagonal().head<3>().array() += sigma_m * sigma_m;
  return measurement;
}

std::string refusalOf(const FusionResult& fusion, std::size_t input, const Vector6d& off) {
  const double sigmas = fusion.weights[input] > 0.0 ? 0.0 : fusion.refused_sigmas[input];
  if (sigmas == 0.0) return "";
  char text[250] = "its pose or its covariance cannot be used: check that they are in m and rad";
  if (std::isfinite(sigmas)) {
    std::snprintf(text, sizeof text,
                  "its pose is %.1f m, in height %.1f m, in yaw %.1f deg from the prediction (%.1f sigma), beyond "
                  "fusion.gate_sigma: check its frame, the datum of its height, its stamps and its covariance",
                  off.head<2>().norm(), std::abs(off[2]), std::abs(off[5]) / kDegree, sigmas);
  }
  return text;
}

std::string ExternalPoseSource::offer(const ExternalPose& pose) {
  std::string reason = unusableReason(pose);
  if (!reason.empty()) return reason;
  if (!poses_.empty() && pose.stamp_s < poses_.back().stamp_s) poses_.clear();
  poses_.push_back(pose);
  offered_ = true;
  if (poses_.size() > kKept) poses_.pop_front();
  return "";
}

std::optional<ExternalPose> ExternalPoseSource::takeNearest(double stamp_s) {
  const auto nearest = std::min_element(poses_.begin(), poses_.end(), [&](const auto& a, const auto& b) {
    return std::abs(a.stamp_s - stamp_s) < std::abs(b.stamp_s - stamp_s);
  });
  if (nearest == poses_.end()) return std::nullopt;
  if (std::exchange(offered_, false)) later_s_ = nearest->stamp_s - stamp_s;
  if (std::abs(nearest->stamp_s - stamp_s) > tolerance_s_) return std::nullopt;
  const ExternalPose found = *nearest;
  poses_.erase(poses_.begin(), nearest + 1);
  return found;
}

std::string ExternalPoseSource::timeFault() const {
  constexpr double kFarOff_s = 1.0;  // no delay of a source that is of use
  if (std::abs(later_s_) <= std::max(kFarOff_s, tolerance_s_)) return "";
  char text[150];
  std::snprintf(text, sizeof text, "its stamp is %.1f s %s the sweep's (tolerance %.2f s): check its clock",
                std::abs(later_s_), later_s_ > 0.0 ? "after" : "before", tolerance_s_);
  return text;
}

std::optional<Measurement> ExternalPoseSource::measure(const SweepPrediction& prediction, const Pose& T_base_cog) {
  later_s_ = 0.0;
  if (!prediction.motionKnown()) return std::nullopt;
  const std::optional<ExternalPose> pose = takeNearest(prediction.stamp_s);
  const std::optional<Vector6d> twist = twistFromIncrement(prediction.T_previous_now(), prediction.dt_s);
  if (!pose || !twist) return std::nullopt;
  return externalMeasurement(*pose, prediction.stamp_s, prediction.T_odom_cog, *twist, T_base_cog);
}

}  // namespace fail_aware
