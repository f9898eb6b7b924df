// The poses of a file in TUM's format.
#pragma once

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "core/io/trajectory_io.hpp"

namespace fail_aware {

inline std::vector<StampedPose> readTumTrajectory(const std::string& path) {
  std::vector<StampedPose> poses;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.rfind('#', 0) == 0) continue;
    std::istringstream row(line);
    StampedPose pose;
    Eigen::Vector3d t;
    Eigen::Quaterniond q;
    if (!(row >> pose.stamp_s >> t.x() >> t.y() >> t.z() >> q.x() >> q.y() >> q.z() >> q.w())) break;
    pose.T = Eigen::Translation3d(t) * q.normalized();
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace fail_aware
