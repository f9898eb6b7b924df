// A pose from elsewhere (GPS, visual odometry, set_pose) with a stamp of its own. Not in the paper.
// Units s, m, rad; covariance in geometry/pose.hpp's convention, a rotation block that is all zero: not measured.
#pragma once

#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"

namespace fail_aware {

struct ExternalPose {
  double stamp_s = 0.0;
  Pose T_odom_base = Pose::Identity();
  Matrix6d covariance = Matrix6d::Zero();
};

}  // namespace fail_aware
