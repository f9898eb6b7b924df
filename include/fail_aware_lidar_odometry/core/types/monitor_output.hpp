// The fail-aware monitor's verdict for one sweep (fail_aware/monitor.hpp). Units: s, m, rad.
#pragma once

#include <cstdint>

#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"
#include "fail_aware_lidar_odometry/core/types/fail_aware_state.hpp"
#include "fail_aware_lidar_odometry/core/types/time_to_failure.hpp"

namespace fail_aware {

struct MonitorOutput {
  double stamp_s = 0.0;
  double t1_stamp_s = -1.0;  ///< -1: does not serve
  FailAwareState state = FailAwareState::kUnknown;
  std::uint32_t reasons = 0;
  TimeToFailure time_to_failure;             ///< what the planner acts on: the earlier of the two
  TimeToFailure time_to_failure_indicator;   ///< from eta
  TimeToFailure time_to_failure_covariance;  ///< from the covariance's growth
  double eta = 0.0;                          ///< fail_aware/indicator.hpp, rad
  double eta_rate_per_s = -1.0;              ///< -1: unknown
  double sigma_yaw_rad = 0.0;                ///< the filter's; -1: unknown
  double sigma_x_m = 0.0;                    ///< accumulated since t1, in the frame at t1
  double sigma_y_m = 0.0;
  Matrix6d covariance_since_start = Matrix6d::Zero();  ///< what sigma_x_m, sigma_y_m are of; geometry/pose.hpp's order
  /// Bounds the horizontal error, with the predictor's confidence; 1e6: nothing does; -1: unknown.
  double protection_level_m = -1.0;
  FailAwareState standby_state = FailAwareState::kUnknown;  ///< before t1: if t1 were now
  TimeToFailure standby_time_to_failure;                    ///< likewise
};

}  // namespace fail_aware
