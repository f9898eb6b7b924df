// The filter's estimate -> nav_msgs/Odometry of base_link.
//
// pose: base_link in odom, covariance accumulated since the start (estimation/odometry_covariance.hpp). twist: in
// base_link at the stamp, the mean over the last sweep; its covariance is that of one increment.
// An unknown motion (dt_s is 0, or the motion is not finite) gives a twist of 0 with the standard deviations
// kUnknownSpeed_mps and kUnknownRate_rps: a filter that takes the message gives it no weight. A covariance of 0 would
// mean standstill.
#pragma once

#include <nav_msgs/Odometry.h>

#include <string>

#include "core/types/filter_state.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"

namespace fail_aware {

/// Standard deviations of an unknown twist: larger than any vehicle's, but the covariance stays well conditioned.
inline constexpr double kUnknownSpeed_mps = 1000.0;
inline constexpr double kUnknownRate_rps = 100.0;

/// `odometry_covariance`: of T_odom_cog. The caller sets the header's stamp, which it has exactly.
nav_msgs::Odometry toOdometryMessage(const FilterState& state, const Matrix6d& odometry_covariance,
                                     const Pose& T_base_cog, const std::string& odom_frame,
                                     const std::string& base_frame);

}  // namespace fail_aware
