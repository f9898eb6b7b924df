// External poses in an offline run: sources of poses that are fused, and poses that are set, both from CSV files
// (io/external_pose_file.hpp).
#pragma once

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/estimation/stamp_order.hpp"
#include "core/io/external_pose_file.hpp"
#include "core/io/input_error.hpp"
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
  explicit PoseQueue(const std::string& path) : path_(path), poses_(readExternalPoses(path)) {}

  /// Takes the poses up to a stamp.
  template <class Take>
  void until(double stamp_s, Take take) {
    for (; next_ < poses_.size() && poses_[next_].stamp_s <= stamp_s; ++next_) take(poses_[next_]);
  }

  /// Why no pose is within these times; empty: one is.
  std::string whyNoneWithin(double first_s, double last_s) const {
    if (poses_.empty()) return path_ + ": there is no pose in it";
    const auto within = [&](const ExternalPose& pose) { return pose.stamp_s >= first_s && pose.stamp_s <= last_s; };
    if (std::any_of(poses_.begin(), poses_.end(), within)) return {};
    const auto span = [](double from_s, double to_s) {
      return "are from " + std::to_string(from_s) + " to " + std::to_string(to_s) + " s";
    };
    return path_ + ": none of its poses has the stamp of a sweep; the stamps of the " + std::to_string(poses_.size()) +
           " poses " + span(poses_.front().stamp_s, poses_.back().stamp_s) + ", those of the sweeps " +
           span(first_s, last_s);
  }

 private:
  std::string path_;
  std::vector<ExternalPose> poses_;
  std::size_t next_ = 0;
};

/// Sources of poses that are fused, and poses that are set.
class PosesFromOutside {
 public:
  PosesFromOutside(const PoseFiles& files, OdometryPipeline& pipeline)
      : pipeline_(pipeline), tolerance_s_(files.tolerance_s) {
    for (const std::string& path : files.external) {
      const std::string name = std::filesystem::path(path).stem().string();
      const auto has_name = [&](const Source& source) { return source.name == name; };
      if (std::any_of(sources_.begin(), sources_.end(), has_name)) {
        throw InputError("--external-poses: two files are named " + name + ", and a source is named after its file");
      }
      sources_.push_back({name, PoseQueue(path)});
      pipeline_.addSource(sources_.back().name, tolerance_s_);
    }
    if (!files.set.empty()) set_.emplace(files.set);
  }

  /// Call before each sweep, with its stamp. One that is far ahead is most likely wrong: it gets none.
  void offer(double stamp_s) {
    first_stamp_s_ = std::min(first_stamp_s_, stamp_s);
    if (stamp_s - std::exchange(last_stamp_s_, stamp_s) > kFarAhead_s) return;
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

  /// Call with each sweep's result.
  void note(double stamp_s, const std::vector<RefusedPose>& refused) {
    for (const RefusedPose& pose : refused) {
      const auto is_source = [&](const Source& source) { return source.name == pose.source; };
      const auto source = std::find_if(sources_.begin(), sources_.end(), is_source);
      if (source->refused++ == 0) source->why = "first at stamp " + std::to_string(stamp_s) + ": " + pose.why;
    }
  }

  /// For the user, at the end: files whose stamps are none of the drive's, and poses that the fusion refused.
  std::vector<std::string> warnings() const {
    std::vector<std::string> found;
    const auto add = [&](const PoseQueue& poses) {
      const std::string why = poses.whyNoneWithin(first_stamp_s_ - tolerance_s_, last_stamp_s_ + tolerance_s_);
      if (!why.empty()) found.push_back(why);
    };
    for (const Source& source : sources_) {
      add(source.poses);
      if (source.refused == 0) continue;
      found.push_back(source.name + ": " + std::to_string(source.refused) + " poses were not used; " + source.why);
    }
    if (set_) add(*set_);
    return found;
  }

 private:
  struct Source {
    std::string name;
    PoseQueue poses;
    std::size_t refused = 0;  ///< by the fusion
    std::string why{};        ///< of the first refused one
  };

  static void warn(const std::string& name, const ExternalPose& pose, const std::string& why) {
    std::cerr << "offline_odometry: warning: " << name << ": the pose at stamp " << std::to_string(pose.stamp_s)
              << " is refused: " << why << std::endl;
  }

  OdometryPipeline& pipeline_;
  double tolerance_s_;
  std::vector<Source> sources_;
  std::optional<PoseQueue> set_;
  double first_stamp_s_ = std::numeric_limits<double>::infinity();
  double last_stamp_s_ = std::numeric_limits<double>::infinity();
};

}  // namespace fail_aware
