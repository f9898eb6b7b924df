// Writes a drive as a KITTI folder, the counterpart of kitti_directory.hpp.
//
//   velodyne/NNNNNN.bin, stamps/NNNNNN.f32 (if sweeps have times), rings/NNNNNN.u16 (if sweeps have rings): add()
//   times.txt, poses.txt (lidar frame, first pose identity), ground_truth_tum.txt (base_link), calib.txt: finish()
// calib.txt has Tr = identity: poses.txt is in the lidar frame, not in a camera's.
//
// Until finish() the folder has the file `unfinished`, and the reader refuses it.
// Failure: InputError if the folder cannot be made or is not empty; std::runtime_error if writing fails.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/io/trajectory_io.hpp"
#include "fail_aware_lidar_odometry/sweep.hpp"

namespace fail_aware {

class KittiWriter {
 public:
  explicit KittiWriter(const std::string& directory);

  /// The next scan; `sweep.times_s` are s from the sweep's start. T_world_lidar: ground truth at the sweep's stamp;
  /// true_stamp_s: the correct stamp, for ground_truth_tum.txt.
  void add(const Sweep& sweep, const Pose& T_world_lidar, const Pose& T_world_base, double true_stamp_s);
  void finish();

  std::size_t size() const { return stamps_s_.size(); }

 private:
  std::string directory_;
  std::vector<double> stamps_s_;
  std::vector<Pose> lidar_poses_;
  std::vector<StampedPose> base_poses_;
};

}  // namespace fail_aware
