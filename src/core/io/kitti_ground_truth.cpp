#include "core/io/kitti_ground_truth.hpp"

#include <filesystem>

#include "core/io/input_error.hpp"
#include "core/io/trajectory_io.hpp"

namespace fail_aware {

KittiGroundTruth readKittiGroundTruth(const std::string& directory, std::size_t scan_count) {
  namespace fs = std::filesystem;
  const fs::path root(directory);
  std::error_code error;
  KittiGroundTruth truth;
  if (fs::exists(root / "poses_velodyne.txt", error)) {
    truth.source = (root / "poses_velodyne.txt").string();
    truth.poses = readKittiTrajectory(truth.source);
  } else if (fs::exists(root / "poses.txt", error)) {
    truth.source = (root / "poses.txt").string();
    truth.poses = readKittiTrajectory(truth.source);
    if (fs::exists(root / "calib.txt", error)) {
      truth.poses = lidarFromCameraTrajectory(truth.poses, readLidarToCamera((root / "calib.txt").string()));
    }
  }
  if (!truth.source.empty() && truth.poses.size() != scan_count) {
    throw InputError(truth.source + ": " + std::to_string(truth.poses.size()) + " rows for " +
                     std::to_string(scan_count) + " scans");
  }
  return truth;
}

}  // namespace fail_aware
