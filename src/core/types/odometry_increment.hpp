// The uncertainty of one sweep's motion: the input of the accumulated covariance (estimation/odometry_covariance.hpp).
// Units: m, rad, s.
#pragma once

#include <optional>

#include "core/geometry/pose.hpp"
#include "core/types/estimator_decisions.hpp"
#include "core/types/motion_doubt.hpp"
#include "core/types/speed_error.hpp"

namespace fail_aware {

/// Covariances about the previous body's axes.
struct OdometryIncrement {
  Matrix6d motion = Matrix6d::Zero();      ///< FilterState::motion_covariance
  std::optional<Matrix6d> registration{};  ///< FilterState::registration_covariance; none: the pose is not measured
  bool confirmed = false;                  ///< at least two measurements agree on the pose
  bool alone = false;                      ///< of one source: nothing confirms or contradicts the pose
  double dt_s = 0.0;
  SpeedError speed_error;
  MotionDoubt doubt;
  MapUpdate map_update = MapUpdate::kInsert;
  double view_range_m = 0.0;  ///< 0: not known
  /// Mean square error of the tilt about odom's axes (VerticalReference::tiltMoment()); none: not known anew.
  std::optional<Eigen::Matrix2d> tilt_moment{};
};

}  // namespace fail_aware
