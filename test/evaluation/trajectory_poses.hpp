// Poses for tests of the measures of a trajectory's error.
#pragma once

#include <vector>

#include "core/geometry/pose.hpp"
#include "core/geometry/rotation.hpp"

namespace fail_aware {

inline Pose at(double x, double y, double z = 0.0, double yaw_rad = 0.0) {
  Pose T = Pose::Identity();
  T.translation() << x, y, z;
  T.linear() = rotationFromRpy(0.0, 0.0, yaw_rad);
  return T;
}

inline Pose someMotion() {
  Vector6d v;
  v << 10.0, -20.0, 3.0, 0.1, -0.2, 2.5;
  return poseFromVector(v);
}

inline std::vector<Pose> moved(const Pose& T, std::vector<Pose> poses) {
  for (Pose& pose : poses) pose = T * pose;
  return poses;
}

}  // namespace fail_aware
