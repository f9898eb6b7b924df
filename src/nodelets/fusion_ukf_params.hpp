// FusionUkf's parameters in its private namespace.
#pragma once

#include <string>

#include "core/estimation/stamp_order.hpp"
#include "core/parameters/check.hpp"
#include "fail_aware_lidar_odometry/bridge/frame_name.hpp"
#include "topics.hpp"

namespace fail_aware {

struct FusionUkfNodeletParams {
  std::string odom_frame = "odom";
  std::string base_frame = "base_link";
  bool publish_tf = true;                   ///< odom_frame -> base_frame
  std::string lidar_in_base_source = "tf";  ///< tf: looked up once; parameter: sensor/lidar_in_base
  double deadline_s = 0.18;                 ///< from predicting a sweep to closing it: before the monitor calls it late
  double late_deadline_s = 0.6;             ///< from a cloud to closing its sweep, if a late source has not answered
  double first_deadline_s = 10.0;           ///< until a motion is known: for sources that are still searching it
  int queue_size = 6;                       ///< number of sweeps that may wait while one is open
  double max_reorder_s = kMaxReorder_s;     ///< two stamps in a row farther back are a time jump: a new drive begins
  int absent_after_sweeps = 3;  ///< consecutive misses, or answers after every deadline, that end the waiting
  int path_max_poses = 2000;
  double path_spacing_m = 0.5;
  int trajectory_max_poses = 200000;  ///< for ~save_trajectory (29 MB, 5.5 h at 10 Hz); the oldest poses are dropped
  std::string trajectory_file = "fail_aware_trajectory_tum.txt";  ///< relative paths: in the node's folder, ~/.ros

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("odom_frame", self.odom_frame);
    v("base_frame", self.base_frame);
    v("publish_tf", self.publish_tf);
    v("lidar_in_base_source", self.lidar_in_base_source);
    v("deadline_s", self.deadline_s, within(0.01, 600.0));
    v("late_deadline_s", self.late_deadline_s, within(0.01, 600.0));
    v("first_deadline_s", self.first_deadline_s, within(0.01, 600.0));
    v("queue_size", self.queue_size, within(1, topics::kMaxWaiting));
    v("max_reorder_s", self.max_reorder_s, requireNotNegative);
    v("absent_after_sweeps", self.absent_after_sweeps, within(1, 1000));
    v("path_max_poses", self.path_max_poses, within(1, 100000));
    v("path_spacing_m", self.path_spacing_m, requireNotNegative);
    v("trajectory_max_poses", self.trajectory_max_poses, within(1, 10000000));
    v("trajectory_file", self.trajectory_file);
  }
  void checkRules() const {
    if (withoutSlash(odom_frame).empty() || withoutSlash(base_frame).empty()) {
      throw ParameterError("odom_frame, base_frame: must not be empty");
    }
    if (withoutSlash(odom_frame) == withoutSlash(base_frame))
      throw ParameterError("odom_frame = " + odom_frame + ": must not be base_frame, too");
    if (lidar_in_base_source != "tf" && lidar_in_base_source != "parameter") {
      throw ParameterError("lidar_in_base_source: must be tf or parameter, not " + lidar_in_base_source);
    }
    if (trajectory_file.empty()) throw ParameterError("trajectory_file: must not be empty");
  }
};

}  // namespace fail_aware
