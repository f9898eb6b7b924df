// The covariance of one sweep's motion, and what the accumulated covariance is made of (odometry_covariance.hpp). Not
// in the paper.
//
// The increment's: one Kalman step from an exactly known pose, the process noise Q against the fused measurement's R.
// Covariances of an increment are about the previous body's axes (m, rad), geometry/pose.hpp's convention.
// Failure: none. Cost: about 5 us.
#pragma once

#include <optional>

#include "core/geometry/pose.hpp"
#include "core/types/filter_state.hpp"
#include "core/types/odometry_increment.hpp"
#include "core/types/sweep_prediction.hpp"

namespace fail_aware {

struct IncrementScale {
  double factor = 1.0;  ///< on what follows from Q and R: the increment's, and the registration's
  /// On both in addition, as weakly observed measurements also mislead, and on the motion's if nothing is registered.
  double dead_reckoning_factor = 1.0;
  double floor_m = 0.0, floor_per_metre_m = 0.0, floor_deg = 0.0;  ///< least standard deviations of the increment
};

/// Sets increment_covariance, motion_covariance, registration_covariance and registered of a state that is otherwise
/// complete.
void setIncrementCovariance(const IncrementScale& scale, const Matrix6d& Q, const SweepPrediction& prediction,
                            FilterState& state);

/// What a clock that was set leaves open:
/// - The distance between the place that a suspected clock jump gives and that of the stamps, if the map is too small
///   to tell them apart: after a gap, either may be right.
/// - What the vehicle may have driven and turned in the time that a clock was set back by, if no two measurements agree
///   on the pose: they began at a prediction that is too short.
MotionDoubt clockDoubt(const SweepPrediction& prediction, const FilterState& state);

/// The increment, for the accumulated covariance.
OdometryIncrement incrementOf(const FilterState& state);

/// The constant body twist (m/s, rad/s; in the moving body's frame, hence also in that at the newest instant) that
/// makes the increment in dt_s. Nothing if the pose is not finite or dt_s is not > 0.
std::optional<Vector6d> twistFromIncrement(const Pose& T_previous_now, double dt_s);

/// Covariance of that twist, to first order; `increment_covariance` about the previous body's axes.
std::optional<Matrix6d> twistCovariance(const Matrix6d& increment_covariance, const Pose& T_previous_now, double dt_s);

}  // namespace fail_aware
