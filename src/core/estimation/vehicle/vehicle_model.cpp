#include "core/estimation/vehicle/vehicle_model.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/rotation.hpp"

namespace fail_aware {

namespace {

constexpr double kNoiseStep_s = 0.1;

// `modelled` if it agrees with `measured` within `trust`, `measured` if they are far apart, blended between.
double blended(double measured, double modelled, double trust) {
  if (trust <= 0.0) return measured;
  const double ratio = (modelled - measured) / trust;
  return measured + (modelled - measured) / (1.0 + ratio * ratio);
}

// Mean over dt of a speed with constant acceleration; braking ends at standstill.
double meanSpeed(double speed, double acceleration, double dt_s) {
  if (speed * (speed + acceleration * dt_s) >= 0.0) return speed + 0.5 * acceleration * dt_s;
  const double stops_after_s = -speed / acceleration;
  return 0.5 * speed * stops_after_s / dt_s;
}

}  // namespace

VehicleModel::VehicleModel(const VehicleParameters& vehicle, const Params& params)
    : vehicle_(vehicle), params_(params), pitch_axis_(pitchAxis(vehicle)), roll_axis_(rollAxis(vehicle)) {}

Matrix6d VehicleModel::processNoise(double dt_s, double yaw_rad) const {
  Vector6d sigma;
  sigma << params_.sigma_x_m, params_.sigma_y_m, params_.sigma_z_m, params_.sigma_roll_rad, params_.sigma_pitch_rad,
      params_.sigma_yaw_rad;
  if (!params_.six_dof) sigma.segment<3>(2).setZero();
  Matrix6d Q = Matrix6d::Zero();
  Q.diagonal() = sigma.cwiseAbs2() * (std::max(dt_s, 0.0) / kNoiseStep_s);
  if (params_.noise_in_body_axes) {
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(yaw_rad).toRotationMatrix();
    Q.topLeftCorner<2, 2>() = (turn * Q.topLeftCorner<2, 2>() * turn.transpose()).eval();
  }
  return Q;
}

LateralState VehicleModel::lateralState(const MotionDerivatives& motion) const {
  return solveLateralDynamics(vehicle_, {motion.velocity_body_mps.x(), motion.acceleration_body_mps2.y(),
                                         motion.rpy_rates_rad_s.z(), motion.rpy_accelerations_rad_s2.z()});
}

Vector6d VehicleModel::predict(const Vector6d& state, const MotionDerivatives& motion, double dt_s,
                               const RoadPlane& road) const {
  if (!motion.valid || !(dt_s > 0.0)) return state;
  return wrapAngles(params_.literal ? predictLiteral(state, motion, dt_s) : predictMended(state, motion, dt_s, road));
}

Vector6d VehicleModel::predictLiteral(const Vector6d& state, const MotionDerivatives& motion, double dt_s) const {
  const LateralState lateral = lateralState(motion);
  const double beta = lateral.beta_rad;
  const double yaw = state[5];
  const double V = std::copysign(motion.velocity_body_mps.head<2>().norm(), motion.velocity_body_mps.x());

  Vector6d after = state;
  after[0] += V * std::cos(yaw + beta) * dt_s;
  after[1] += V * std::sin(yaw + beta) * dt_s;
  after[5] += V * std::cos(beta) / vehicle_.wheelbase_m() * std::tan(lateral.delta_rad) * dt_s;
  if (!params_.six_dof) return after;

  const Eigen::Vector3d& rates = motion.rpy_rates_rad_s;
  const Eigen::Vector3d& acceleration = motion.acceleration_body_mps2;
  after[3] = stepSuspensionLiteral(roll_axis_, {state[3], rates.x()}, acceleration.y(), dt_s).angle_rad;
  after[4] = stepSuspensionLiteral(pitch_axis_, {state[4], rates.y()}, acceleration.x(), dt_s).angle_rad;
  after[2] = vehicle_.cog_height_m + vehicle_.cog_above_pitch_axis_m * (std::cos(after[4]) - 1.0) +
             vehicle_.cog_above_roll_axis_m * (std::cos(after[3]) - 1.0);
  return after;
}

Vector6d VehicleModel::predictMended(const Vector6d& state, const MotionDerivatives& motion, double dt_s,
                                     const RoadPlane& road) const {
  const Eigen::Vector3d velocity_body = meanBodyVelocity(motion, dt_s);
  Vector6d after = state;
  after[5] += (motion.rpy_rates_rad_s.z() + 0.5 * motion.rpy_accelerations_rad_s2.z() * dt_s) * dt_s;

  Eigen::Vector3d rpy_before(0.0, 0.0, state[5]), rpy_after(0.0, 0.0, after[5]);
  if (params_.six_dof) {
    after.segment<2>(3) = rollPitchAfter(state, motion, dt_s, after[5], road);
    rpy_before.head<2>() = state.segment<2>(3);
    rpy_after.head<2>() = after.segment<2>(3);
  }
  const Eigen::Matrix3d R_before = rotationFromRpy(rpy_before.x(), rpy_before.y(), rpy_before.z());
  const Eigen::Matrix3d R_after = rotationFromRpy(rpy_after.x(), rpy_after.y(), rpy_after.z());
  Vector6d twist;
  twist << velocity_body * dt_s, logSo3(R_before.transpose() * R_after);
  const Eigen::Vector3d step_odom = R_before * expSe3(twist).translation();
  if (params_.six_dof) {
    after.head<3>() += step_odom;
  } else {
    after.head<2>() += step_odom.head<2>();
  }
  return after;
}

Eigen::Vector3d VehicleModel::meanBodyVelocity(const MotionDerivatives& motion, double dt_s) const {
  Eigen::Vector3d mean = motion.velocity_body_mps + 0.5 * dt_s * motion.acceleration_body_mps2;
  mean.z() = motion.velocity_body_mps.z();
  mean.x() = meanSpeed(motion.velocity_body_mps.x(), motion.acceleration_body_mps2.x(), dt_s);

  MotionDerivatives middle = motion;
  middle.velocity_body_mps.x() = mean.x();
  middle.rpy_rates_rad_s += 0.5 * dt_s * motion.rpy_accelerations_rad_s2;
  mean.y() = blended(mean.y(), mean.x() * std::tan(lateralState(middle).beta_rad), params_.lateral_trust_mps);
  return mean;
}

// (roll, pitch) after dt: those of the road plus the suspension's free and forced motion about them.
Eigen::Vector2d VehicleModel::rollPitchAfter(const Vector6d& state, const MotionDerivatives& motion, double dt_s,
                                             double yaw_after_rad, const RoadPlane& road) const {
  const Eigen::Vector2d before = state.segment<2>(3);
  const Eigen::Vector2d rates = motion.rpy_rates_rad_s.head<2>();
  Eigen::Vector2d at_constant_rates = before + rates * dt_s;
  if (!road.valid) return at_constant_rates;

  const Eigen::Vector2d road_before = road.rollPitch(state[5]);
  const Eigen::Vector2d road_after = road.rollPitch(yaw_after_rad, dt_s);
  const Eigen::Vector2d deviation = before - road_before;
  // the measured rates are means over the past interval, so the road's rates must be, too
  const Eigen::Vector2d road_earlier = road.rollPitch(state[5] - motion.rpy_rates_rad_s.z() * dt_s, -dt_s);
  const Eigen::Vector2d deviation_rate = rates - (road_before - road_earlier) / dt_s;
  const Eigen::Vector2d resting = restingRollPitch(roll_axis_, pitch_axis_, motion);
  const SuspensionAxis* axes[2] = {&roll_axis_, &pitch_axis_};
  Eigen::Vector2d after;
  for (int i = 0; i < 2; ++i) {
    const double acceleration_mps2 =
        axes[i]->gain_per_m > 0.0 ? resting[i] * axes[i]->stiffness_per_s2 / axes[i]->gain_per_m : 0.0;
    after[i] = road_after[i] +
               stepSuspensionExact(*axes[i], {deviation[i], deviation_rate[i]}, acceleration_mps2, dt_s).angle_rad;
  }
  return at_constant_rates + params_.suspension_gain * (after - at_constant_rates);
}

}  // namespace fail_aware
