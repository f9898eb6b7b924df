// Slip angle beta and front wheel angle delta from the vehicle's motion (paper, section "Kinematic and Dynamic Vehicle
// Model", the equations of transversal dynamics and of the slip angles).
//
//   F_yf + F_yr = m (y'' + psi' v_x)          F_yf = C_f (delta - beta - l_f psi' / v_x)
//   l_f F_yf - l_r F_yr = I_z psi''           F_yr = C_r (-beta + l_r psi' / v_x)
//
// Four linear equations, four unknowns. In reverse the tyre forces change sign with the direction of rolling (beta and
// delta stay v_y / v_x and the wheel's angle). Below 1 m/s the slip equations are replaced by their kinematic
// limit tan(beta) = l_r psi' / v_x, tan(delta) = (l_f + l_r) psi' / v_x; the two blend smoothly up to twice that speed.
// Path curvature psi' / v_x is limited to what the steering allows and goes to zero at standstill.
// Never fails for finite inputs. Cost: two arctangents.
#pragma once

#include "core/estimation/vehicle/vehicle_parameters.hpp"

namespace fail_aware {

struct LateralMotion {
  double speed_x_mps = 0.0;              ///< v_x, body axes, negative in reverse
  double acceleration_y_mps2 = 0.0;      ///< y'', derivative of the body-axes v_y (without psi' v_x)
  double yaw_rate_rad_s = 0.0;           ///< psi'
  double yaw_acceleration_rad_s2 = 0.0;  ///< psi''
};

/// Limits the curvature: a car's steering lock.
inline constexpr double kMaxSteeringAngle_rad = 0.7;

struct LateralState {
  double beta_rad = 0.0;
  double delta_rad = 0.0;
};

LateralState solveLateralDynamics(const VehicleParameters& vehicle, const LateralMotion& motion);

}  // namespace fail_aware
