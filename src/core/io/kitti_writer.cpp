#include "core/io/kitti_writer.hpp"

#include <cstdio>
#include <filesystem>

#include "core/io/input_error.hpp"
#include "core/io/kitti_directory.hpp"
#include "core/io/output_file.hpp"

namespace fail_aware {

namespace {

namespace fs = std::filesystem;

template <class T>
void writeArray(const fs::path& path, const std::vector<T>& values) {
  std::ofstream file = createFile(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
  finishFile(file, path);
}

// Writes files beginning with the first sweep that has a value for each of its points.
template <class Value>
void writeSideFile(const fs::path& folder, const std::string& name, const std::vector<Value>& values,
                   std::size_t points) {
  const bool of_points = values.size() == points && points > 0;
  if (!of_points && !fs::exists(folder)) return;
  fs::create_directories(folder);
  writeArray(folder / name, values);
}

}  // namespace

KittiWriter::KittiWriter(const std::string& directory) : directory_(directory) {
  const fs::path root(directory);
  std::error_code error;
  if (fs::is_directory(root, error) && !fs::is_empty(root, error)) {
    throw InputError(directory + ": is not empty; remove it or give another folder");
  }
  fs::create_directories(root / "velodyne", error);
  if (error) throw InputError(directory + ": cannot be made: " + error.message());
  writeText(root / kKittiUnfinished, "");
}

void KittiWriter::add(const Sweep& sweep, const Pose& T_world_lidar, const Pose& T_world_base, double true_stamp_s) {
  char name[32];
  std::snprintf(name, sizeof name, "%06zu", size());
  const fs::path root(directory_);
  std::vector<float> points;
  points.reserve(4 * sweep.size());
  for (std::size_t i = 0; i < sweep.size(); ++i) {
    const Eigen::Vector3f& p = sweep.points_lidar[i];
    points.insert(points.end(), {p.x(), p.y(), p.z(), sweep.intensities.empty() ? 0.0f : sweep.intensities[i]});
  }
  writeArray(root / "velodyne" / (std::string(name) + ".bin"), points);
  writeSideFile(root / "stamps", std::string(name) + ".f32", sweep.times_s, sweep.size());
  writeSideFile(root / "rings", std::string(name) + ".u16", sweep.rings, sweep.size());
  stamps_s_.push_back(sweep.stamp_s);
  lidar_poses_.push_back(T_world_lidar);
  base_poses_.push_back({true_stamp_s, T_world_base});
}

void KittiWriter::finish() {
  const fs::path root(directory_);
  std::string times;
  for (double stamp_s : stamps_s_) {
    char line[32];
    std::snprintf(line, sizeof line, "%.6f\n", stamp_s);
    times += line;
  }
  writeText(root / "times.txt", times);
  writeText(root / "calib.txt", "Tr: 1 0 0 0 0 1 0 0 0 0 1 0\n");
  std::vector<Pose> poses;
  for (const Pose& T : lidar_poses_) poses.push_back(orthonormalized(lidar_poses_.front().inverse() * T));
  writeKittiTrajectory((root / "poses.txt").string(), poses);
  std::vector<StampedPose> base;
  for (const StampedPose& pose : base_poses_) {
    base.push_back({pose.stamp_s, orthonormalized(base_poses_.front().T.inverse() * pose.T)});
  }
  writeTumTrajectory((root / "ground_truth_tum.txt").string(), base);
  fs::remove(root / kKittiUnfinished);
}

}  // namespace fail_aware
