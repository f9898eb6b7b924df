// What the odometry says about one sweep. Units: s, m, rad.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "fail_aware_lidar_odometry/monitor.hpp"

namespace fail_aware {

enum class SweepStatus {
  kNotStarted,  ///< no sweep had usable points yet: the odometry has not begun
  kFirst,       ///< defines odom, or, where stamps jumped, goes on from the last pose; not registered
  kCorrected,   ///< measured and fused
  kPredicted,   ///< no usable measurement: the pose is the prediction
  /// Duplicate, out of order, far ahead: refused. Pose, covariance and monitor are the last ones; from the third on the
  /// state is FAILED (STALE).
  kStampNotAdvancing,
};

const char* toString(SweepStatus status);

struct Result {
  double stamp_s = 0.0;  ///< the pose is that of this instant
  SweepStatus status = SweepStatus::kNotStarted;
  /// Of base_link in odom: p_odom = T_odom_base p_base. Identity before the first usable sweep.
  Eigen::Isometry3d T_odom_base = Eigen::Isometry3d::Identity();
  /// Of T_odom_base, accumulated since the start of the drive. That of nav_msgs/Odometry: order x y z, rotation about
  /// the fixed axes x y z of odom; m^2, m rad, rad^2.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  MonitorOutput monitor;  ///< state, reasons, time to failure
  /// Why a pose that was set could not be taken. Empty: it is done, it waits for an observed motion, or there was none.
  std::string pose_set_refused;

  bool hasPose() const { return status != SweepStatus::kNotStarted && status != SweepStatus::kStampNotAdvancing; }
};

}  // namespace fail_aware
