// The covariance of one sweep's motion, and the part of it that the measurements do not observe. Not in the paper.
//
// One Kalman step from an exactly known pose: the process noise Q against the fused measurement's R.
// Covariances of an increment are about the previous body's axes (m, rad), geometry/pose.hpp's convention.
// Failure: none. Cost: about 5 us.
#pragma once

#include "core/geometry/pose.hpp"
#include "core/types/filter_state.hpp"
#include "core/types/odometry_increment.hpp"
#include "core/types/sweep_prediction.hpp"

namespace fail_aware {

/// Lower bounds of an increment's standard deviations.
struct IncrementFloor {
  double sigma_m = 0.0, sigma_per_metre_m = 0.0, sigma_deg = 0.0;
};

/// Sets increment_covariance and unobserved_covariance of a state that is otherwise complete. `scale` multiplies the
/// covariance that follows from Q and R.
void setIncrementCovariance(const IncrementFloor& floor, const Matrix6d& Q, double scale,
                            const SweepPrediction& prediction, FilterState& state);

/// The increment, for the accumulated covariance.
OdometryIncrement incrementOf(const FilterState& state);

}  // namespace fail_aware
