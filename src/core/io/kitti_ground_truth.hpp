// The true trajectory beside a recorded drive in KITTI's folder layout, one row a scan, in the lidar frame.
//
//   DIR/poses_velodyne.txt            the lidar's
//   or DIR/poses.txt and calib.txt    the camera's, as KITTI gives it; the line `Tr:` brings it to the lidar
//   or DIR/poses.txt alone            the lidar's
//
// Throws InputError as the readers of core/io/trajectory_io.hpp do, and for a count of rows that is not the scans'.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/geometry/pose.hpp"

namespace fail_aware {

struct KittiGroundTruth {
  std::string source;       ///< the file; empty: there is none
  std::vector<Pose> poses;  ///< T_first_lidar of each scan, relative to the file's own origin
};

KittiGroundTruth readKittiGroundTruth(const std::string& directory, std::size_t scan_count);

}  // namespace fail_aware
