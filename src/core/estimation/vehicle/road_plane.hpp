// The slowly varying plane of the road under the vehicle, from the filter's past estimates. Not in the paper: the
// paper's suspension pulls pitch and roll to zero, which is wrong on a slope; it should pull them to this plane.
//
// The plane is stored as its slopes dz/dx and dz/dy in odom, so that turning on a hill does not change it.
// Each estimate's attitude, minus the suspension's resting angles under the current accelerations, is one observation
// of the plane; slope and its rate of change follow with a fading memory (critically damped, any interval between
// stamps). Failure: an observation that is not finite, or steeper than 60 degrees, or whose stamp does not advance, is
// ignored. Cost: < 1 us, no allocation.
#pragma once

#include <Eigen/Core>

#include "core/estimation/vehicle/motion_derivatives.hpp"
#include "core/estimation/vehicle/suspension.hpp"
#include "core/estimation/vehicle/vehicle_parameters.hpp"
#include "core/geometry/pose.hpp"

namespace fail_aware {

/// At the stamp of the newest estimate.
struct RoadPlane {
  bool valid = false;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< dz/dx, dz/dy in odom
  Eigen::Vector2d slope_rate_per_s = Eigen::Vector2d::Zero();

  /// Roll and pitch of a body that stands flat on the plane with this heading, `ahead_s` after the newest estimate. The
  /// slope is extrapolated for at most 0.5 s: how the road goes on after that is not known.
  Eigen::Vector2d rollPitch(double yaw_rad, double ahead_s = 0.0) const;
};

/// The suspension's resting roll and pitch (REP-103 signs) under the motion's inertial accelerations.
Eigen::Vector2d restingRollPitch(const SuspensionAxis& roll_axis, const SuspensionAxis& pitch_axis,
                                 const MotionDerivatives& motion);

class RoadPlaneEstimator {
 public:
  explicit RoadPlaneEstimator(const VehicleParameters& vehicle)
      : pitch_axis_(pitchAxis(vehicle)), roll_axis_(rollAxis(vehicle)) {}

  /// `state`: the estimate at stamp_s; `motion`: the derivatives there.
  void update(double stamp_s, const Vector6d& state, const MotionDerivatives& motion);

  const RoadPlane& plane() const { return plane_; }
  /// Turns the plane with an odom that is turned by R_new_old.
  void turn(const Eigen::Matrix3d& R_new_old);
  void clear();

 private:
  SuspensionAxis pitch_axis_;
  SuspensionAxis roll_axis_;
  RoadPlane plane_;
  double stamp_s_ = 0.0;
};

}  // namespace fail_aware
