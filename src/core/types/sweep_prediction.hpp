// The filter's prediction for one sweep (estimation/pose_filter.hpp): the sweep is deskewed with it, and registration
// starts from it.
// Poses: of the centre of gravity in odom; m, rad, s.
#pragma once

#include "core/geometry/pose.hpp"
#include "core/types/estimator_decisions.hpp"

namespace fail_aware {

struct SweepPrediction {
  double stamp_s = 0.0;
  double stamp_error_s = 0.0;                   ///< SweepTime::error_s
  double period_s = 0.0;                        ///< of the head; 0: not known yet
  double dt_s = 0.0;                            ///< since the last estimate; 0 in the first sweep
  Pose T_odom_cog_previous = Pose::Identity();  ///< last estimate
  Pose T_odom_cog = Pose::Identity();           ///< prediction at the stamp
  Matrix6d covariance = Matrix6d::Identity();   ///< of the prediction, geometry/pose.hpp's convention
  double sigma_yaw_rad = 0.0;
  MotionStatus motion_status = MotionStatus::kUnknown;  ///< of the last estimate
  int odom_reset_count = 0;                             ///< as in FilterState
  double set_back_s = 0.0;                              ///< from SweepTime

  bool isFirst() const { return !(dt_s > 0.0); }  ///< of the drive
  bool motionKnown() const { return motion_status != MotionStatus::kUnknown; }
  double time_s() const { return stamp_s - stamp_error_s; }
  Pose T_previous_now() const { return T_odom_cog_previous.inverse() * T_odom_cog; }
};

}  // namespace fail_aware
