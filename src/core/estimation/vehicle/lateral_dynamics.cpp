#include "core/estimation/vehicle/lateral_dynamics.hpp"

#include <algorithm>
#include <cmath>

namespace fail_aware {

namespace {

constexpr double kMinSpeed_mps = 1.0;     // below: kinematic bicycle
constexpr double kStandstill_mps = 0.05;  // below: the curvature goes to zero

double smoothStep(double x) {
  const double t = std::clamp(x, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace

LateralState solveLateralDynamics(const VehicleParameters& vehicle, const LateralMotion& motion) {
  const double l_f = vehicle.cog_to_front_axle_m;
  const double l_r = vehicle.cog_to_rear_axle_m;
  const double wheelbase = l_f + l_r;
  const double v_x = motion.speed_x_mps;

  const double lateral_force = vehicle.mass_kg * (motion.acceleration_y_mps2 + motion.yaw_rate_rad_s * v_x);
  const double yaw_moment = vehicle.inertia_z_kg_m2 * motion.yaw_acceleration_rad_s2;
  const double force_front_n = (l_r * lateral_force + yaw_moment) / wheelbase;
  const double force_rear_n = (l_f * lateral_force - yaw_moment) / wheelbase;

  const double max_curvature = std::tan(kMaxSteeringAngle_rad) / wheelbase;
  const double curvature =
      std::clamp(motion.yaw_rate_rad_s * v_x / std::max(v_x * v_x, kStandstill_mps * kStandstill_mps), -max_curvature,
                 max_curvature);

  const double beta_kinematic = std::atan(l_r * curvature);
  const double delta_kinematic = std::atan(wheelbase * curvature);

  const double rolling = v_x < 0.0 ? -1.0 : 1.0;
  const double beta_dynamic = l_r * curvature - rolling * force_rear_n / vehicle.cornering_stiffness_rear_n_per_rad;
  const double delta_dynamic =
      beta_dynamic + l_f * curvature + rolling * force_front_n / vehicle.cornering_stiffness_front_n_per_rad;

  const double dynamic_ratio = smoothStep((std::abs(v_x) - kMinSpeed_mps) / kMinSpeed_mps);
  LateralState state;
  state.beta_rad = beta_kinematic + dynamic_ratio * (beta_dynamic - beta_kinematic);
  state.delta_rad = delta_kinematic + dynamic_ratio * (delta_dynamic - delta_kinematic);
  return state;
}

}  // namespace fail_aware
