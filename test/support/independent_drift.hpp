// Errors of successive sweeps that know nothing of each other: all of a sweep's uncertainty stays.
#pragma once

#include "core/estimation/drift_model.hpp"
#include "core/types/odometry_increment.hpp"

namespace fail_aware {

inline DriftModel independentDrift() {
  DriftModel params;
  params.map_length_m = 0.0;
  params.registration_ratio = 1.0;
  params.position_per_root_metre_m = 0.0;
  params.tilt_per_root_metre_deg = 0.0;
  params.heading_per_root_metre_deg = 0.0;
  params.heading_bias_deg_per_m = 0.0;
  params.scale_bias = 0.0;
  params.transient_ratio = 0.0;
  params.transient_rotation_ratio = 0.0;
  params.new_map_m = 0.0;
  return params;
}

/// `covariance`: of a sweep's motion, about the previous body's axes.
inline OdometryIncrement incrementWith(const Matrix6d& covariance) {
  OdometryIncrement increment;
  increment.motion = covariance;
  return increment;
}

}  // namespace fail_aware
