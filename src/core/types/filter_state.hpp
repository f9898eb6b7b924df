// The filter's estimate for one sweep (estimation/pose_filter.hpp), with the fusion's result and the increment since
// the last estimate.
// Poses: of the centre of gravity in odom; m, rad, s.
#pragma once

#include "core/geometry/pose.hpp"
#include "core/types/estimator_decisions.hpp"
#include "core/types/fusion_result.hpp"
#include "core/types/motion_doubt.hpp"
#include "core/types/speed_error.hpp"

namespace fail_aware {

struct FilterState {
  double stamp_s = 0.0;
  double stamp_error_s = 0.0;  ///< SweepTime::error_s
  double dt_s = 0.0;           ///< since the last estimate; 0 in the first sweep
  Pose T_odom_cog = Pose::Identity();
  Matrix6d covariance = Matrix6d::Identity();  ///< the filter's P, of (x, y, z, roll, pitch, yaw)
  double sigma_yaw_rad = 0.0;                  ///< from P; the input of eta
  bool measurement_applied = false;            ///< false: the estimate is the prediction
  bool started = true;                         ///< false: no sweep had usable points yet, so the drive has not begun
  MotionStatus motion_status = MotionStatus::kUnknown;
  FusionResult fusion;
  double filter_nis = 0.0;                           ///< of the fused measurement, 6 degrees of freedom
  Pose T_previous_now = Pose::Identity();            ///< increment of the centre of gravity
  Matrix6d increment_covariance = Matrix6d::Zero();  ///< of the increment, about the previous body's axes
  /// What the accumulated covariance is made of (estimation/odometry_covariance.hpp), about the previous body's axes:
  /// of the motion since the last estimate without the map, and of the place in the map that the measurements give
  /// (only if `registered`).
  Matrix6d motion_covariance = Matrix6d::Zero();
  Matrix6d registration_covariance = Matrix6d::Zero();
  bool registered = false;
  MotionDoubt doubt;
  SpeedError speed_error;  ///< along the vehicle's axis, during dead reckoning
  /// The interval of the stamps since the last inserted sweep is not the time driven: the increment is not a motion
  /// over dt_s.
  bool clock_jump = false;
  double set_back_s = 0.0;    ///< from SweepPrediction
  double view_range_m = 0.0;  ///< from SweepFindings; 0: not known
  int odom_reset_count = 0;   ///< number of setPose() calls: references with another number belong to another odom
  MapUpdate map_update = MapUpdate::kSkip;

  bool motionObserved() const { return motion_status == MotionStatus::kObserved; }
  bool inMap() const { return map_update != MapUpdate::kSkip; }

  double time_s() const { return stamp_s - stamp_error_s; }
};

}  // namespace fail_aware
