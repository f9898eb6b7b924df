// The motion model of the filter's sigma points (paper, section "Kinematic and Dynamic Vehicle Model").
//
// State (x, y, z, roll, pitch, yaw) of the centre of gravity in odom, m and rad, REP-103. Modes:
// - literal, six_dof: the paper's equations unchanged: beta and delta from the tyre forces, one Euler step of
//     X' = V cos(psi + beta), Y' = V sin(psi + beta), psi' = V cos(beta) / (l_f + l_r) tan(delta),
//   pitch and roll by angle + angle' dt + angle'' dt^2 / 2,
//   z = COG_z + d_pitch (cos pitch - 1) + d_roll (cos roll - 1).
//   V has the sign of v_x, so that reversing works.
// - mended (literal = false), six_dof, the default. Differences, and why:
//   * suspension: pitch and roll oscillate about a slowly varying road plane, not about zero; exact solution over dt;
//     in REP-103's sign of pitch; driven by the inertial lateral acceleration (y'' + psi' v_x), not y''. The change
//     that this adds to constant rates is multiplied by `suspension_gain`.
//   * yaw: psi' dt + psi'' dt^2 / 2. This is the bicycle's relation with the axles' velocity directions instead of the
//     wheels' directions (the slip angles between them cancel).
//   * position, z included: the mean body velocity over dt along the arc. v_y is the bicycle's v_x tan(beta) if the
//     measured v_y agrees with it within `lateral_trust_mps`. This filters noise, and it changes the motion of a
//     vehicle that is not such a bicycle by at most half of that value. v_z is measured, so z follows the road.
//   * a braking vehicle stops; it does not roll back.
// - six_dof = false: only x, y, yaw change; z, roll, pitch stay and have no process noise.
// Failure: derivatives that are not valid -> the vehicle stands still. Finite input gives finite output. Cost: < 1 us.
#pragma once

#include "core/estimation/vehicle/lateral_dynamics.hpp"
#include "core/estimation/vehicle/motion_derivatives.hpp"
#include "core/estimation/vehicle/road_plane.hpp"
#include "core/estimation/vehicle/suspension.hpp"
#include "core/estimation/vehicle/vehicle_parameters.hpp"
#include "core/geometry/pose.hpp"
#include "core/parameters/check.hpp"

namespace fail_aware {

class VehicleModel {
 public:
  struct Params {
    bool six_dof = true;
    bool literal = false;
    /// 0: constant pitch and roll rates, 1: the full suspension; half, since a vehicle's constants are never exact
    double suspension_gain = 0.5;
    double lateral_trust_mps = 0.2;  ///< 0: measured v_y only
    // Process noise: the paper's standard deviations after 0.1 s; variances grow in proportion to time.
    double sigma_x_m = 0.0485;
    double sigma_y_m = 0.0435;
    double sigma_z_m = 0.121;
    double sigma_roll_rad = 0.1456;
    double sigma_pitch_rad = 0.1456;
    double sigma_yaw_rad = 0.0044;
    bool noise_in_body_axes = true;  ///< x forward, y left; false (paper): odom's axes

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("six_dof", self.six_dof);
      v("literal", self.literal);
      v("sigma_x_m", self.sigma_x_m, requirePositive);
      v("sigma_y_m", self.sigma_y_m, requirePositive);
      v("sigma_z_m", self.sigma_z_m, requirePositive);
      v("sigma_roll_rad", self.sigma_roll_rad, requirePositive);
      v("sigma_pitch_rad", self.sigma_pitch_rad, requirePositive);
      v("sigma_yaw_rad", self.sigma_yaw_rad, requirePositive);
      v("noise_in_body_axes", self.noise_in_body_axes);
    }
  };

  VehicleModel(const VehicleParameters& vehicle, const Params& params);

  /// The state dt_s >= 0 later. `road` may be invalid (no estimate yet): then pitch and roll keep their rates.
  Vector6d predict(const Vector6d& state, const MotionDerivatives& motion, double dt_s, const RoadPlane& road) const;

  /// Q for one step of dt_s; yaw_rad turns the x and y noise into odom (see `noise_in_body_axes`).
  Matrix6d processNoise(double dt_s, double yaw_rad) const;

  const VehicleParameters& vehicle() const { return vehicle_; }

 private:
  LateralState lateralState(const MotionDerivatives& motion) const;
  Vector6d predictLiteral(const Vector6d& state, const MotionDerivatives& motion, double dt_s) const;
  Vector6d predictMended(const Vector6d& state, const MotionDerivatives& motion, double dt_s,
                         const RoadPlane& road) const;
  Eigen::Vector3d meanBodyVelocity(const MotionDerivatives& motion, double dt_s) const;
  Eigen::Vector2d rollPitchAfter(const Vector6d& state, const MotionDerivatives& motion, double dt_s,
                                 double yaw_after_rad, const RoadPlane& road) const;

  VehicleParameters vehicle_;
  Params params_;
  SuspensionAxis pitch_axis_;
  SuspensionAxis roll_axis_;
};

}  // namespace fail_aware
