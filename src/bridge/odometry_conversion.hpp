// The filter's estimate -> nav_msgs/Odometry of base_link.
//
// pose: base_link in odom, covariance accumulated since the start (estimation/odometry_covariance.hpp). twist: in base_link
// at the stamp, the mean over the last sweep; its covariance is that of one increment.
// A motion that is not known (dt_s is 0, or it is not finite) is a twist of 0 with kUnknownSpeed_mps and kUnknownRate_rps
// as standard deviations: a filter that takes the message gives it no weight. A covariance of 0 would say standstill.
#pragma once

#include <nav_msgs/Odometry.h>

#include <string>

#include "core/types/filter_state.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"

namespace fail_aware {

/// Of a twist that is not known: more than any vehicle's, yet the covariance is well conditioned.
inline constexpr double kUnknownSpeed_mps = 1000.0;
inline constexpr double kUnknownRate_rps = 100.0;

/// `odometry_covariance`: of T_odom_cog. The header's stamp is left to the caller, who has it exactly.
nav_msgs::Odometry toOdometryMessage(const FilterState& state, const Matrix6d& odometry_covariance,
                                     const Pose& T_base_cog, const std::string& odom_frame,
                                     const std::string& base_frame);

}  // namespace fail_aware
