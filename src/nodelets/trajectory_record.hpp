// Every pose since the start (or the last reset), for ~save_trajectory. 144 bytes a pose; beyond the limit the oldest
// poses are dropped and counted.
#pragma once

#include <cstddef>
#include <deque>
#include <string>
#include <vector>

#include "core/io/trajectory_io.hpp"

namespace fail_aware {

class TrajectoryRecord {
 public:
  explicit TrajectoryRecord(std::size_t max_poses) : max_poses_(max_poses) {}

  void add(double stamp_s, const Pose& T_odom_base) {
    poses_.push_back({stamp_s, T_odom_base});
    if (poses_.size() <= max_poses_) return;
    poses_.pop_front();
    ++forgotten_;
  }
  void clear() {
    poses_.clear();
    forgotten_ = 0;
  }

  std::size_t size() const { return poses_.size(); }
  std::size_t forgotten() const { return forgotten_; }

  /// TUM format. Throws InputError or std::runtime_error if it cannot be written.
  void save(const std::string& path) const {
    writeTumTrajectory(path, std::vector<StampedPose>(poses_.begin(), poses_.end()));
  }

 private:
  std::size_t max_poses_;
  std::deque<StampedPose> poses_;
  std::size_t forgotten_ = 0;
};

}  // namespace fail_aware
