#include "core/estimation/vehicle/suspension.hpp"

#include <cmath>

namespace fail_aware {

SuspensionAxis pitchAxis(const VehicleParameters& vehicle) {
  const double l_f = vehicle.cog_to_front_axle_m, l_r = vehicle.cog_to_rear_axle_m;
  const double l_f2 = l_f * l_f, l_r2 = l_r * l_r;
  const double arm = vehicle.cog_above_pitch_axis_m;
  const double spring = (vehicle.spring_front_n_per_m * l_f2 + vehicle.spring_rear_n_per_m * l_r2) / 2.0;
  const double damper = (vehicle.damper_front_ns_per_m * l_f2 + vehicle.damper_rear_ns_per_m * l_r2) / 2.0;
  const double inertia = vehicle.inertia_y_kg_m2 + vehicle.mass_kg * (arm * arm);
  return {damper / inertia, (spring + vehicle.mass_kg * kGravity_mps2 * arm) / inertia,
          vehicle.mass_kg * arm / inertia};
}

SuspensionAxis rollAxis(const VehicleParameters& vehicle) {
  const double t_f = vehicle.track_front_m, t_r = vehicle.track_rear_m;
  const double t_f2 = t_f * t_f, t_r2 = t_r * t_r;
  const double arm = vehicle.cog_above_roll_axis_m;
  const double spring = (vehicle.spring_front_n_per_m * t_f2 + vehicle.spring_rear_n_per_m * t_r2) / 2.0;
  const double damper = vehicle.damper_front_ns_per_m * t_f2 + vehicle.damper_rear_ns_per_m * t_r2;
  const double inertia = vehicle.inertia_x_kg_m2 + vehicle.mass_kg * (arm * arm);
  return {damper / inertia, (spring + vehicle.mass_kg * kGravity_mps2 * arm) / inertia,
          vehicle.mass_kg * arm / inertia};
}

SuspensionState stepSuspensionLiteral(const SuspensionAxis& axis, const SuspensionState& start,
                                      double acceleration_mps2, double dt_s) {
  const double angular_acceleration = axis.gain_per_m * acceleration_mps2 - axis.stiffness_per_s2 * start.angle_rad -
                                      axis.damping_per_s * start.rate_rad_s;
  return {start.angle_rad + start.rate_rad_s * dt_s + 0.5 * angular_acceleration * dt_s * dt_s,
          start.rate_rad_s + angular_acceleration * dt_s};
}

SuspensionState stepSuspensionExact(const SuspensionAxis& axis, const SuspensionState& start, double acceleration_mps2,
                                    double dt_s) {
  // About the resting angle: q(t) = q0 c + (q0' + h q0) s, q'(t) = q0' c - (k q0 + h q0') s, h = damping / 2, with
  // c = e^-ht cosh(rt), s = e^-ht sinh(rt) / r, r^2 = h^2 - k; cos and sin when r^2 < 0.
  const double rest = restingAngle(axis, acceleration_mps2);
  const double h = 0.5 * axis.damping_per_s;
  const double r2 = h * h - axis.stiffness_per_s2;
  const double x2 = r2 * dt_s * dt_s;
  double c, s;
  if (std::abs(x2) < 1e-6) {
    const double decay = std::exp(-h * dt_s);
    c = decay * (1.0 + x2 / 2.0);
    s = decay * dt_s * (1.0 + x2 / 6.0);
  } else if (r2 > 0.0) {
    const double r = std::sqrt(r2);
    const double slow = std::exp(-axis.stiffness_per_s2 / (h + r) * dt_s);
    const double fast = std::exp(-(h + r) * dt_s);
    c = 0.5 * (slow + fast);
    s = 0.5 * (slow - fast) / r;
  } else {
    const double w = std::sqrt(-r2);
    const double decay = std::exp(-h * dt_s);
    c = decay * std::cos(w * dt_s);
    s = decay * std::sin(w * dt_s) / w;
  }
  const double q0 = start.angle_rad - rest;
  const double rate0 = start.rate_rad_s;
  return {rest + q0 * c + (rate0 + h * q0) * s, rate0 * c - (axis.stiffness_per_s2 * q0 + h * rate0) * s};
}

double restingAngle(const SuspensionAxis& axis, double acceleration_mps2) {
  return axis.gain_per_m * acceleration_mps2 / axis.stiffness_per_s2;
}

}  // namespace fail_aware
