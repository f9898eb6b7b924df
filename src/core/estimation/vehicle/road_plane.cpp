#include "core/estimation/vehicle/road_plane.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/rotation.hpp"
#include "core/stamp_difference.hpp"

namespace fail_aware {

namespace {

constexpr double kMemory_s = 0.5;  // of the road's slope: about one oscillation of the suspension

}  // namespace

Eigen::Vector2d RoadPlane::rollPitch(double yaw_rad, double ahead_s) const {
  // R = Rz(yaw) Ry(pitch) Rx(roll) takes e_z to the plane's normal; in axes along the heading this normal is
  // (sin pitch cos roll, -sin roll, cos pitch cos roll).
  const Eigen::Vector2d gradient = slope + std::clamp(ahead_s, -kMemory_s, kMemory_s) * slope_rate_per_s;
  const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  const double along = c * gradient.x() + s * gradient.y();
  const double across = -s * gradient.x() + c * gradient.y();
  return {std::atan2(across, std::hypot(1.0, along)), -std::atan(along)};
}

Eigen::Vector2d restingRollPitch(const SuspensionAxis& roll_axis, const SuspensionAxis& pitch_axis,
                                 const MotionDerivatives& motion) {
  const double lateral_mps2 =
      motion.acceleration_body_mps2.y() + motion.rpy_rates_rad_s.z() * motion.velocity_body_mps.x();
  const double longitudinal_mps2 =
      motion.acceleration_body_mps2.x() - motion.rpy_rates_rad_s.z() * motion.velocity_body_mps.y();
  return {restingAngle(roll_axis, lateral_mps2), restingAngle(pitch_axis, -longitudinal_mps2)};
}

void RoadPlaneEstimator::update(double stamp_s, const Vector6d& state, const MotionDerivatives& motion) {
  if (!std::isfinite(stamp_s) || !state.allFinite()) return;
  if (plane_.valid && stamp_s <= stamp_s_) return;

  const Eigen::Vector2d resting = restingRollPitch(roll_axis_, pitch_axis_, motion);
  const Eigen::Vector3d normal =
      rotationFromRpy(state[3] - resting[0], state[4] - resting[1], state[5]) * Eigen::Vector3d::UnitZ();
  if (!(normal.z() > 0.5)) return;
  const Eigen::Vector2d observed = -normal.head<2>() / normal.z();

  if (!plane_.valid) {
    plane_.valid = true;
    plane_.slope = observed;
  } else {
    const double dt_s = secondsBetween(stamp_s_, stamp_s);
    const double memory = std::exp(-dt_s / kMemory_s);
    plane_.slope += dt_s * plane_.slope_rate_per_s;
    const Eigen::Vector2d surprise = observed - plane_.slope;
    plane_.slope += (1.0 - memory * memory) * surprise;
    plane_.slope_rate_per_s += (1.0 - memory) * (1.0 - memory) / dt_s * surprise;
  }
  stamp_s_ = stamp_s;
}

void RoadPlaneEstimator::turn(const Eigen::Matrix3d& R_new_old) {
  if (!plane_.valid) return;
  // Both the normal n ~ (-slope, 1) and its rate of change turn.
  const Eigen::Vector3d n = R_new_old * Eigen::Vector3d(-plane_.slope.x(), -plane_.slope.y(), 1.0);
  const Eigen::Vector3d n_rate =
      R_new_old * Eigen::Vector3d(-plane_.slope_rate_per_s.x(), -plane_.slope_rate_per_s.y(), 0.0);
  if (!(n.z() > 0.5 * n.norm())) {
    clear();
    return;
  }
  plane_.slope = -n.head<2>() / n.z();
  plane_.slope_rate_per_s = -(n_rate.head<2>() + plane_.slope * n_rate.z()) / n.z();
}

void RoadPlaneEstimator::clear() { plane_ = RoadPlane(); }

}  // namespace fail_aware
