#include "simulation/vehicle_drive.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/rotation.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware {

namespace {

constexpr double kAirDrag_kg_per_m = 0.42;  // half air density times drag area
constexpr double kRolling = 0.012;
constexpr double kLookAhead_m = 3.5, kLookAhead_s = 0.55;
constexpr double kMaxSteering_rad = 0.6, kMaxSteeringRate_rps = 0.7, kSteeringLag_s = 0.12;
constexpr double kWander_m = 0.12, kWander_per_m = 2.0 * M_PI / 170.0;  // no driver stays exactly in the lane's middle
constexpr double kSpeedGain_per_s = 1.5;
constexpr double kKinematicBelow_mps = 1.5;  // slip angles are singular at rest
constexpr int kDriverEvery = 10;             // steps
constexpr double kStandstill_mps = 0.05;
constexpr double kLastBraking_mps2 = 1.0;
constexpr double kOwnStart = 0.7;  // of the limit

double tyreForce(double stiffness, double slip_rad, double limit_n) {
  return limit_n > 1.0 ? limit_n * std::tanh(stiffness * slip_rad / limit_n) : 0.0;
}

}  // namespace

void VehicleDrive::Params::validate() const {
  fail_aware::validate(vehicle);
  speed.validate();
  requireWithin("start_speed_mps", start_speed_mps, -1.0, 60.0);
  requireWithin("friction", friction, 0.1, 1.5);
  requirePositive("max_drive_mps2", max_drive_mps2);
  requirePositive("max_brake_mps2", max_brake_mps2);
  requirePositive("max_jerk_mps3", max_jerk_mps3);
}

VehicleDrive::VehicleDrive(std::uint64_t seed, const Params& params, const Road& road, const Terrain& terrain)
    : params_(params), speed_(seed, params.speed) {
  params_.validate();
  const RoadPoint start = road.at(0.0);
  state_.position = start.position - road.laneOffset(0.0) * start.left();
  state_.yaw_rad = start.heading_rad;
  state_.forward_mps = params_.start_speed_mps;
  if (params_.start_speed_mps < 0.0) {
    const SceneKind kind = road.kindAt(0.0);
    state_.forward_mps = kind == SceneKind::kTown ? 0.0 : kOwnStart * roadCharacter(kind).speed_mps;
  }
  const Eigen::Vector2d slope = terrain.gradient(state_.position);
  state_.height_m = terrain.height(state_.position) + params_.vehicle.cog_height_m;
  state_.pitch_rad = -std::atan(slope.dot(start.forward()));
  state_.roll_rad = std::atan(slope.dot(start.left()));
  const double l_f = params_.vehicle.cog_to_front_axle_m, l_r = params_.vehicle.cog_to_rear_axle_m;
  ground_m_ << roadHeight(terrain, l_f, 0.75), roadHeight(terrain, l_f, -0.75), roadHeight(terrain, -l_r, 0.75),
      roadHeight(terrain, -l_r, -0.75);
  // the springs settle before the drive begins
  const State begin = state_;
  for (int i = 0; i < 3000; ++i) moveOnSprings(ground_m_);
  state_.position = begin.position;
}

Pose VehicleDrive::T_world_base() const {
  Pose T_world_cog = Pose::Identity();
  T_world_cog.linear() = rotationFromRpy(state_.roll_rad, state_.pitch_rad, state_.yaw_rad);
  T_world_cog.translation() << state_.position, state_.height_m;
  const double axles_middle = 0.5 * (params_.vehicle.cog_to_front_axle_m - params_.vehicle.cog_to_rear_axle_m);
  return T_world_cog * Eigen::Translation3d(axles_middle, 0.0, -params_.vehicle.cog_height_m);
}

double VehicleDrive::roadHeight(const Terrain& terrain, double forward_m, double left_m) const {
  const double c = std::cos(state_.yaw_rad), s = std::sin(state_.yaw_rad);
  const Eigen::Vector2d p = state_.position + Eigen::Vector2d(c * forward_m - s * left_m, s * forward_m + c * left_m);
  return terrain.height(p) + terrain.roadRoughness(p);
}

void VehicleDrive::drive(const Road& road) {
  const double speed = state_.forward_mps;
  target_mps_ = speed_.target(road, state_.s_m, speed, state_.t_s);

  // steering: the circle through the point ahead on the lane (pure pursuit), from the rear axle
  const double ahead_m = kLookAhead_m + kLookAhead_s * speed;
  const double s = state_.s_m + ahead_m;
  const RoadPoint point = road.at(s);
  const double lateral = -road.laneOffset(s) + kWander_m * std::sin(kWander_per_m * s);
  const Eigen::Vector2d aim = point.position + lateral * point.left();
  const Eigen::Vector2d forward(std::cos(state_.yaw_rad), std::sin(state_.yaw_rad));
  const Eigen::Vector2d rear = state_.position - params_.vehicle.cog_to_rear_axle_m * forward;
  const Eigen::Vector2d to_aim = aim - rear;
  const double left = -forward.y() * to_aim.x() + forward.x() * to_aim.y();
  const double curvature = 2.0 * left / std::max(1.0, to_aim.squaredNorm());
  const double wanted =
      std::clamp(std::atan(curvature * params_.vehicle.wheelbase_m()), -kMaxSteering_rad, kMaxSteering_rad);
  const double dt = kDriverEvery * kStep_s;
  const double rate =
      std::clamp((wanted - state_.steering_rad) / kSteeringLag_s, -kMaxSteeringRate_rps, kMaxSteeringRate_rps);
  state_.steering_rad += rate * dt;

  const double wanted_mps2 =
      std::clamp(kSpeedGain_per_s * (target_mps_ - speed), -params_.max_brake_mps2, params_.max_drive_mps2);
  const double jerk_step = params_.max_jerk_mps3 * dt;
  state_.command_mps2 += std::clamp(wanted_mps2 - state_.command_mps2, -jerk_step, jerk_step);
}

VehicleDrive::AxleForces VehicleDrive::lateralForces() const {
  const VehicleParameters& car = params_.vehicle;
  const double vx = state_.forward_mps;
  const double front_slip =
      state_.steering_rad - std::atan2(state_.left_mps + car.cog_to_front_axle_m * state_.yaw_rate_rps, vx);
  const double rear_slip = -std::atan2(state_.left_mps - car.cog_to_rear_axle_m * state_.yaw_rate_rps, vx);
  const auto axle = [&](double stiffness, double slip, double left_load, double right_load) {
    return tyreForce(0.5 * stiffness, slip, params_.friction * left_load) +
           tyreForce(0.5 * stiffness, slip, params_.friction * right_load);
  };
  const Eigen::Vector4d& load = state_.wheel_loads_n;
  return {axle(car.cornering_stiffness_front_n_per_rad, front_slip, load[0], load[1]),
          axle(car.cornering_stiffness_rear_n_per_rad, rear_slip, load[2], load[3])};
}

void VehicleDrive::moveOnPlane(double slope, double bank) {
  const VehicleParameters& car = params_.vehicle;
  const double vx = state_.forward_mps;
  const double old_left_mps = state_.left_mps;
  // the command is the felt acceleration: the driver compensates slope and resistance up to the friction limit
  const double resistance =
      kAirDrag_kg_per_m * vx * std::abs(vx) / car.mass_kg + (vx > 0.0 ? kRolling * kGravity_mps2 : 0.0);
  const double traction = std::clamp(state_.command_mps2 + resistance + kGravity_mps2 * slope,
                                     -params_.friction * kGravity_mps2, 0.5 * params_.friction * kGravity_mps2);
  double forward_mps2 = traction - resistance - kGravity_mps2 * slope;

  if (vx < kKinematicBelow_mps) {  // the wheels roll in their direction, without slip
    const double follow = kStep_s / 0.05;
    const double rate = vx * std::tan(state_.steering_rad) / car.wheelbase_m();
    state_.yaw_rate_rps += follow * (rate - state_.yaw_rate_rps);
    state_.left_mps += follow * (car.cog_to_rear_axle_m * rate - state_.left_mps);
    state_.left_mps2 = (state_.left_mps - old_left_mps) / kStep_s + state_.yaw_rate_rps * vx;
  } else {
    const AxleForces force = lateralForces();
    const double c = std::cos(state_.steering_rad), s = std::sin(state_.steering_rad);
    forward_mps2 -= force.front_n * s / car.mass_kg;
    state_.left_mps2 = (force.front_n * c + force.rear_n) / car.mass_kg - kGravity_mps2 * bank;
    state_.left_mps += kStep_s * (state_.left_mps2 - state_.yaw_rate_rps * vx);
    state_.yaw_rate_rps += kStep_s *
                           (car.cog_to_front_axle_m * force.front_n * c - car.cog_to_rear_axle_m * force.rear_n) /
                           car.inertia_z_kg_m2;
  }
  double next_mps = vx + kStep_s * (forward_mps2 + state_.yaw_rate_rps * old_left_mps);
  if (target_mps_ < kStandstill_mps && next_mps < kStandstill_mps) {  // the brakes hold
    next_mps = std::max(0.0, vx - kStep_s * kLastBraking_mps2);
    state_.command_mps2 = std::max(state_.command_mps2, 0.0);
  }
  next_mps = std::max(0.0, next_mps);
  state_.forward_mps2 = (next_mps - vx) / kStep_s - state_.yaw_rate_rps * old_left_mps;
  state_.forward_mps = next_mps;

  const double middle_yaw = state_.yaw_rad + 0.5 * kStep_s * state_.yaw_rate_rps;
  const double c = std::cos(middle_yaw), s = std::sin(middle_yaw);
  state_.position += kStep_s * Eigen::Vector2d(c * state_.forward_mps - s * state_.left_mps,
                                               s * state_.forward_mps + c * state_.left_mps);
  state_.yaw_rad += kStep_s * state_.yaw_rate_rps;
}

void VehicleDrive::moveOnSprings(const Eigen::Vector4d& ground_m) {
  const VehicleParameters& car = params_.vehicle;
  const double l_f = car.cog_to_front_axle_m, l_r = car.cog_to_rear_axle_m;
  const std::array<double, 4> forward = {l_f, l_f, -l_r, -l_r};
  const std::array<double, 4> left = {0.5 * car.track_front_m, -0.5 * car.track_front_m, 0.5 * car.track_rear_m,
                                      -0.5 * car.track_rear_m};
  double lift_n = 0.0, pitch_nm = 0.0, roll_nm = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const bool front = i < 2;
    const double corner_m = state_.height_m - state_.pitch_rad * forward[i] + state_.roll_rad * left[i];
    const double corner_mps =
        state_.height_rate_mps - state_.pitch_rate_rps * forward[i] + state_.roll_rate_rps * left[i];
    const double ground_mps = (ground_m[k] - ground_m_[k]) / kStep_s;
    const double static_n = 0.5 * car.mass_kg * kGravity_mps2 * (front ? l_r : l_f) / car.wheelbase_m();
    const double spring = front ? car.spring_front_n_per_m : car.spring_rear_n_per_m;
    const double damper = front ? car.damper_front_ns_per_m : car.damper_rear_ns_per_m;
    const double force = std::max(
        0.0, static_n + spring * (ground_m[k] + car.cog_height_m - corner_m) + damper * (ground_mps - corner_mps));
    state_.wheel_loads_n[k] = force;
    lift_n += force;
    pitch_nm -= forward[i] * force;
    roll_nm += left[i] * force;
  }
  ground_m_ = ground_m;
  // inertia acts above the axes; what the springs do not carry goes through the links straight into the wheels
  pitch_nm -= car.mass_kg * car.cog_above_pitch_axis_m * state_.forward_mps2;
  roll_nm += car.mass_kg * car.cog_above_roll_axis_m * state_.left_mps2;
  const double link_pitch_n =
      car.mass_kg * (car.cog_height_m - car.cog_above_pitch_axis_m) * state_.forward_mps2 / (2.0 * car.wheelbase_m());
  const double link_roll_n =
      car.mass_kg * (car.cog_height_m - car.cog_above_roll_axis_m) * state_.left_mps2 / (2.0 * car.track_front_m);
  for (Eigen::Index i = 0; i < 4; ++i) {
    const double transfer = (i < 2 ? -link_pitch_n : link_pitch_n) + (i % 2 == 0 ? -link_roll_n : link_roll_n);
    state_.wheel_loads_n[i] = std::max(0.0, state_.wheel_loads_n[i] + transfer);
  }
  const double d_pitch = car.cog_above_pitch_axis_m, d_roll = car.cog_above_roll_axis_m;
  state_.height_rate_mps += kStep_s * (lift_n / car.mass_kg - kGravity_mps2);
  state_.pitch_rate_rps += kStep_s * pitch_nm / (car.inertia_y_kg_m2 + car.mass_kg * d_pitch * d_pitch);
  state_.roll_rate_rps += kStep_s * roll_nm / (car.inertia_x_kg_m2 + car.mass_kg * d_roll * d_roll);
  state_.height_m += kStep_s * state_.height_rate_mps;
  state_.pitch_rad += kStep_s * state_.pitch_rate_rps;
  state_.roll_rad += kStep_s * state_.roll_rate_rps;
}

void VehicleDrive::step(const Road& road, const Terrain& terrain) {
  const VehicleParameters& car = params_.vehicle;
  if (steps_ % kDriverEvery == 0) {
    state_.s_m = road.project(state_.position, state_.s_m);
    drive(road);
  }
  ++steps_;
  const double l_f = car.cog_to_front_axle_m, l_r = car.cog_to_rear_axle_m;
  const double half_f = 0.5 * car.track_front_m, half_r = 0.5 * car.track_rear_m;
  const Eigen::Vector4d ground_m(roadHeight(terrain, l_f, half_f), roadHeight(terrain, l_f, -half_f),
                                 roadHeight(terrain, -l_r, half_r), roadHeight(terrain, -l_r, -half_r));
  const double slope = (ground_m[0] + ground_m[1] - ground_m[2] - ground_m[3]) / (2.0 * car.wheelbase_m());
  const double bank = (ground_m[0] - ground_m[1] + ground_m[2] - ground_m[3]) / (2.0 * car.track_front_m);
  moveOnPlane(slope, bank);
  moveOnSprings(ground_m);
  state_.t_s = kStep_s * steps_;
}

}  // namespace fail_aware
