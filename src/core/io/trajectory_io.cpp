#include "core/io/trajectory_io.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <sstream>

#include "core/io/input_error.hpp"
#include "core/io/output_file.hpp"
#include "core/io/stamp_unit.hpp"
#include "core/io/text_lines.hpp"

namespace fail_aware {

namespace {

constexpr double kRotationTolerance = 1e-3;
constexpr int kPoseDigits = 12;

std::ifstream openForReading(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw InputError(path + ": is a directory, not a file");
  errno = 0;
  std::ifstream file(path);
  if (!file) throw InputError(path + ": cannot be opened: " + std::strerror(errno));
  skipByteOrderMark(file, path);
  return file;
}

std::string place(const std::string& path, std::size_t line) { return path + ":" + std::to_string(line) + ": "; }

std::vector<double> parseNumbers(const std::string& text, std::size_t count, const std::string& where) {
  std::istringstream words(text);
  std::vector<double> numbers;
  std::string word;
  while (words >> word) {
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    if (*end != '\0') {
      throw InputError(where + "'" + word + "' is not a number; a row has " + std::to_string(count));
    }
    if (!std::isfinite(value)) throw InputError(where + "'" + word + "' is not finite");
    numbers.push_back(value);
  }
  if (numbers.size() != count) {
    throw InputError(where + "expected " + std::to_string(count) + (count == 1 ? " number" : " numbers") + ", found " +
                     std::to_string(numbers.size()));
  }
  return numbers;
}

Pose poseFromRow(const std::vector<double>& row, const std::string& where) {
  Pose T = Pose::Identity();
  T.matrix().topRows<3>() = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(row.data());
  const Eigen::Matrix3d R = T.linear();
  const bool is_rotation = (R.transpose() * R).isIdentity(kRotationTolerance) && R.determinant() > 0.0;
  if (!is_rotation) throw InputError(where + "the 3x3 part is not a rotation");
  return orthonormalized(T);
}

/// Calls row(text, "FILE:LINE: ") for every line with data.
template <class Row>
void forEachRow(const std::string& path, Row&& row) {
  std::ifstream file = openForReading(path);
  std::size_t line = 0, empty_line = 0;
  for (std::string text; nextLine(file, text);) {
    ++line;
    const std::size_t begin = text.find_first_not_of(" \t\r");
    if (begin == std::string::npos) {
      if (empty_line == 0) empty_line = line;
      continue;
    }
    if (empty_line != 0) throw InputError(place(path, empty_line) + "empty line before the end of the data");
    row(text, place(path, line));
  }
  if (file.bad()) throw InputError(place(path, line + 1) + "cannot be read");
}

void requireRows(std::size_t rows, const std::string& path, const char* what) {
  if (rows == 0) throw InputError(path + ": holds no " + what);
}

}  // namespace

std::vector<Pose> readKittiTrajectory(const std::string& path) {
  std::vector<Pose> poses;
  forEachRow(path, [&](const std::string& text, const std::string& where) {
    if (text.front() == '#') throw InputError(where + "not KITTI's rows of 12 numbers; match_truth makes them");
    poses.push_back(poseFromRow(parseNumbers(text, 12, where), where));
  });
  requireRows(poses.size(), path, "poses");
  return poses;
}

void writeKittiTrajectory(const std::string& path, const std::vector<Pose>& poses) {
  std::ofstream file = createFile(path);
  file << std::setprecision(kPoseDigits);
  for (const Pose& T : poses) {
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 4; ++c) file << T(r, c) << (r == 2 && c == 3 ? '\n' : ' ');
    }
  }
  finishFile(file, path);
}

void writeTumTrajectory(const std::string& path, const std::vector<StampedPose>& poses) {
  std::ofstream file = createFile(path);
  file << "# stamp x y z qx qy qz qw\n";
  for (const StampedPose& pose : poses) {
    const Eigen::Vector3d t = pose.T.translation();
    Eigen::Quaterniond q(pose.T.linear());
    if (q.w() < 0.0) q.coeffs() = -q.coeffs();
    file << std::fixed << std::setprecision(9) << pose.stamp_s << std::defaultfloat << std::setprecision(kPoseDigits);
    for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) file << ' ' << value;
    file << '\n';
  }
  finishFile(file, path);
}

std::vector<double> readTimes(const std::string& path) {
  std::vector<double> times;
  forEachRow(path, [&](const std::string& text, const std::string& where) {
    const double time_s = parseNumbers(text, 1, where).front();
    if (!times.empty() && time_s < times.back()) throw InputError(where + "the time goes back");
    times.push_back(time_s);
  });
  requireRows(times.size(), path, "times");
  requireSeconds(path, times);
  return times;
}

Pose readLidarToCamera(const std::string& path) {
  std::ifstream file = openForReading(path);
  std::size_t line = 0;
  for (std::string text; nextLine(file, text);) {
    ++line;
    if (text.rfind("Tr:", 0) == 0) {
      return poseFromRow(parseNumbers(text.substr(3), 12, place(path, line)), place(path, line));
    }
  }
  throw InputError(path + ": has no line 'Tr:' (12 numbers, lidar to camera)");
}

std::vector<Pose> lidarFromCameraTrajectory(const std::vector<Pose>& camera_poses, const Pose& T_camera_lidar) {
  const Pose T_lidar_camera = T_camera_lidar.inverse();
  std::vector<Pose> lidar_poses;
  lidar_poses.reserve(camera_poses.size());
  for (const Pose& T_camera0_camera : camera_poses) {
    lidar_poses.push_back(T_lidar_camera * T_camera0_camera * T_camera_lidar);
  }
  return lidar_poses;
}

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

bool movesLikeACamera(const std::vector<Pose>& poses) {
  constexpr double kStandstill_m = 1.0;  // noise of a truth that stands still may add up to this
  double across_m = 0.0, along_z_m = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Eigen::Vector3d way =
        poses[i - 1].linear().transpose() * (poses[i].translation() - poses[i - 1].translation());
    across_m += way.head<2>().norm();
    along_z_m += std::abs(way.z());
  }
  return along_z_m > std::max(across_m, kStandstill_m);
}

}  // namespace fail_aware
