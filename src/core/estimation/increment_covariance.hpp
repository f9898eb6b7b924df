// The covariance of one sweep's motion, and the part of it that the measurement leaves open. Not in the paper.
//
// One Kalman step from a pose known exactly: the process noise Q against the fused measurement's R.
// Covariances of an increment about the previous body's axes (m, rad), geometry/pose.hpp's convention.
// Failure: none. Cost: about 5 us.
#pragma once

#include "core/geometry/pose.hpp"
#include "core/types/filter_state.hpp"
#include "core/types/odometry_increment.hpp"
#include "core/types/sweep_prediction.hpp"

namespace fail_aware {

/// Standard deviations that an increment has at least.
struct IncrementFloor {
  double sigma_m = 0.0, sigma_per_metre_m = 0.0, sigma_deg = 0.0;
};

/// Sets increment_covariance and unobserved_covariance of a state that is complete otherwise. `scale`: on what Q and R
/// say.
void setIncrementCovariance(const IncrementFloor& floor, const Matrix6d& Q, double scale,
                            const SweepPrediction& prediction, FilterState& state);

/// For the accumulated covariance.
OdometryIncrement incrementOf(const FilterState& state);

}  // namespace fail_aware
