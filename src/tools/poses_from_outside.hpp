// External poses in an offline run: sources of poses that are fused, and poses that are set, both from CSV files
// (io/external_pose_file.hpp).
#pragma once

#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "core/io/external_pose_file.hpp"
#include "core/odometry_pipeline.hpp"

namespace fail_aware {

struct PoseFiles {
  std::vector<std::string> external;  ///< one source per file, named after it
  std::string set;                    ///< empty: none
  double tolerance_s = 0.1;           ///< largest difference between the stamps of a pose and of its sweep
};

/// Poses of a file, in the order of their stamps; each is taken once.
class PoseQueue {
 public:
  explicit PoseQueue(const std::string& path) : poses_(readExternalPoses(path)) {}

  /// Takes the poses up to a stamp.
  template <class Take>
  void until(double stamp_s, Take take) {
    for (; next_ < poses_.size() && poses_[next_].stamp_s <= stamp_s; ++next_) take(poses_[next_]);
  }

 private:
  std::vector<ExternalPose> poses_;
  std::size_t next_ = 0;
};

/// Sources of poses that are fused, and poses that are set.
class PosesFromOutside {
 public:
  PosesFromOutside(const PoseFiles& files, OdometryPipeline& pipeline)
      : pipeline_(pipeline), tolerance_s_(files.tolerance_s) {
    for (const std::string& path : files.external) {
      sources_.push_back({std::filesystem::path(path).stem().string(), PoseQueue(path)});
      pipeline_.addSource(sources_.back().name, tolerance_s_);
    }
    if (!files.set.empty()) set_.emplace(files.set);
  }

  /// Call before the sweep with this stamp.
  void offer(double stamp_s) {
    for (Source& source : sources_) {
      source.poses.until(stamp_s + tolerance_s_, [&](const ExternalPose& pose) {
        const std::string refused = pipeline_.offer(source.name, pose);
        if (!refused.empty()) warn(source.name, pose, refused);
      });
    }
    if (!set_) return;
    set_->until(stamp_s, [&](const ExternalPose& pose) {
      const std::string refused = pipeline_.setPose(pose);
      if (!refused.empty()) warn("--set-pose", pose, refused);
    });
  }

 private:
  struct Source {
    std::string name;
    PoseQueue poses;
  };

  static void warn(const std::string& name, const ExternalPose& pose, const std::string& why) {
    std::cerr << "offline_odometry: warning: " << name << ": the pose at stamp " << std::to_string(pose.stamp_s)
              << " is refused: " << why << std::endl;
  }

  OdometryPipeline& pipeline_;
  double tolerance_s_;
  std::vector<Source> sources_;
  std::optional<PoseQueue> set_;
};

}  // namespace fail_aware
