// Trajectories as text, in the two formats that evaluation tools know.
//
// KITTI: one pose a row, 12 numbers, the upper 3x4 of the matrix row by row; no stamps.
// TUM:   one pose a row, "stamp x y z qx qy qz qw" (s, m); lines that begin with # are comments. Only written.
//
// Readers throw InputError naming file and line for: a file that cannot be opened, a wrong count of numbers, a word
// that is not a number, a number that is not finite, a matrix that is not a rotation (beyond 1e-3), an empty line
// before the last pose, and a file without poses. Rotations are orthonormalized. Writers throw InputError if the file
// cannot be opened, and std::runtime_error if it cannot be completed (disk full).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/geometry/pose.hpp"

namespace fail_aware {

struct StampedPose {
  double stamp_s = 0.0;
  Pose T = Pose::Identity();
};

std::vector<Pose> readKittiTrajectory(const std::string& path);
void writeKittiTrajectory(const std::string& path, const std::vector<Pose>& poses);

void writeTumTrajectory(const std::string& path, const std::vector<StampedPose>& poses);

/// One stamp per row (KITTI's times.txt), s; must not decrease.
std::vector<double> readTimes(const std::string& path);

/// T_camera_lidar: the line `Tr:` of a KITTI odometry calib.txt.
Pose readLidarToCamera(const std::string& path);

/// KITTI's ground truth is the camera's: T_lidar0_lidar = Tr^-1 T_camera0_camera Tr.
std::vector<Pose> lidarFromCameraTrajectory(const std::vector<Pose>& camera_poses, const Pose& T_camera_lidar);

/// The ground truth of a recorded drive in KITTI's folder layout.
struct KittiGroundTruth {
  std::string source;       ///< the file; empty: no ground truth
  std::vector<Pose> poses;  ///< T_first_lidar of each scan, relative to the file's own origin
};

/// DIR/poses_velodyne.txt (lidar poses), or DIR/poses.txt: of the camera, as KITTI gives them, if there is a calib.txt
/// to convert them, else of the lidar. Throws InputError, also if the number of rows is not that of the scans.
KittiGroundTruth readKittiGroundTruth(const std::string& directory, std::size_t scan_count);

/// Whether the motion between the poses is mostly along z: then the frame is a camera's (z ahead), not a lidar's.
bool movesLikeACamera(const std::vector<Pose>& poses);
/// What a message says of such poses.
inline constexpr const char* kMovesLikeACamera = "moves along its z axis, as KITTI's poses of the camera do";

}  // namespace fail_aware
