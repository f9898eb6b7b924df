// The ground truth of a recorded drive in KITTI's folder layout, one row per scan, in the lidar frame.
//
//   DIR/poses_velodyne.txt            lidar poses
//   or DIR/poses.txt and calib.txt    camera poses, as KITTI gives them; the line `Tr:` converts them to the lidar
//   or DIR/poses.txt alone            lidar poses
//
// Throws InputError as the readers of core/io/trajectory_io.hpp do, and if the number of rows is not that of the scans.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/geometry/pose.hpp"

namespace fail_aware {

struct KittiGroundTruth {
  std::string source;       ///< the file; empty: no ground truth
  std::vector<Pose> poses;  ///< T_first_lidar of each scan, relative to the file's own origin
};

KittiGroundTruth readKittiGroundTruth(const std::string& directory, std::size_t scan_count);

}  // namespace fail_aware
