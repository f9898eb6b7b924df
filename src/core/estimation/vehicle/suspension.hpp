// Pitch and roll on springs and dampers (paper, section "Kinematic and Dynamic Vehicle Model", the pitch and roll
// equations). Both are  angle'' + damping angle' + stiffness angle = gain acceleration  after division by the inertia:
//
//   pitch: inertia I_y + m d_pitch^2, stiffness K_pitch + m g d_pitch, damping D_pitch, gain m d_pitch
//   roll:  inertia I_x + m d_roll^2,  stiffness K_rf + K_rr + m g d_roll, damping D_rf + D_rr, gain m d_roll
//
// Signs as in the paper: a forward acceleration gives a positive pitch, which is nose up. In REP-103 positive pitch is
// nose down; a caller that uses REP-103 negates the acceleration. Angles in rad. Never fails for finite inputs.
#pragma once

#include "core/estimation/vehicle/vehicle_parameters.hpp"

namespace fail_aware {

struct SuspensionAxis {
  double damping_per_s = 0.0;
  double stiffness_per_s2 = 1.0;  ///< > 0
  double gain_per_m = 0.0;        ///< rad/s^2 per m/s^2
};

struct SuspensionState {
  double angle_rad = 0.0;
  double rate_rad_s = 0.0;
};

SuspensionAxis pitchAxis(const VehicleParameters& vehicle);
SuspensionAxis rollAxis(const VehicleParameters& vehicle);

/// The paper's step: angle + rate dt + angle'' dt^2 / 2, with angle'' at the start.
SuspensionState stepSuspensionLiteral(const SuspensionAxis& axis, const SuspensionState& start,
                                      double acceleration_mps2, double dt_s);

/// The exact solution of the linear equation after dt with constant acceleration; under-, over- and critically damped.
SuspensionState stepSuspensionExact(const SuspensionAxis& axis, const SuspensionState& start, double acceleration_mps2,
                                    double dt_s);

/// The angle at which the body rests under a constant acceleration.
double restingAngle(const SuspensionAxis& axis, double acceleration_mps2);

}  // namespace fail_aware
