#include "core/io/trajectory_io.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <locale>
#include <sstream>
#include <stdexcept>

#include "core/io/input_error.hpp"
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

std::ofstream openForWriting(const std::string& path) {
  errno = 0;
  std::ofstream file(path);
  if (!file) throw InputError(path + ": cannot be written: " + std::strerror(errno));
  file.imbue(std::locale::classic());
  return file;
}

void finishWriting(std::ofstream& file, const std::string& path) {
  file.close();
  if (!file) throw std::runtime_error(path + ": could not be written to its end");
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

/// Calls row(text, "FILE:LINE: ") for every line with data; returns their number.
template <class Row>
std::size_t forEachRow(const std::string& path, bool has_comments, Row&& row) {
  std::ifstream file = openForReading(path);
  std::size_t line = 0, rows = 0, empty_line = 0;
  for (std::string text; nextLine(file, text);) {
    ++line;
    const std::size_t begin = text.find_first_not_of(" \t\r");
    if (has_comments && begin != std::string::npos && text[begin] == '#') continue;
    if (begin == std::string::npos) {
      if (empty_line == 0) empty_line = line;
      continue;
    }
    if (empty_line != 0) throw InputError(place(path, empty_line) + "empty line before the end of the data");
    row(text, place(path, line));
    ++rows;
  }
  if (file.bad()) throw InputError(place(path, line + 1) + "cannot be read");
  return rows;
}

void requireRows(std::size_t rows, const std::string& path, const char* what) {
  if (rows == 0) throw InputError(path + ": holds no " + what);
}

}  // namespace

std::vector<Pose> readKittiTrajectory(const std::string& path) {
  std::vector<Pose> poses;
  forEachRow(path, false, [&](const std::string& text, const std::string& where) {
    poses.push_back(poseFromRow(parseNumbers(text, 12, where), where));
  });
  requireRows(poses.size(), path, "poses");
  return poses;
}

void writeKittiTrajectory(const std::string& path, const std::vector<Pose>& poses) {
  std::ofstream file = openForWriting(path);
  file << std::setprecision(kPoseDigits);
  for (const Pose& T : poses) {
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 4; ++c) file << T(r, c) << (r == 2 && c == 3 ? '\n' : ' ');
    }
  }
  finishWriting(file, path);
}

std::vector<StampedPose> readTumTrajectory(const std::string& path) {
  std::vector<StampedPose> poses;
  forEachRow(path, true, [&](const std::string& text, const std::string& where) {
    const std::vector<double> n = parseNumbers(text, 8, where);
    const Eigen::Quaterniond q(n[7], n[4], n[5], n[6]);
    if (std::abs(q.norm() - 1.0) > kRotationTolerance) throw InputError(where + "the quaternion's norm is not 1");
    StampedPose pose;
    pose.stamp_s = n[0];
    pose.T.translation() << n[1], n[2], n[3];
    pose.T.linear() = q.normalized().toRotationMatrix();
    poses.push_back(pose);
  });
  requireRows(poses.size(), path, "poses");
  return poses;
}

void writeTumTrajectory(const std::string& path, const std::vector<StampedPose>& poses) {
  std::ofstream file = openForWriting(path);
  file << "# stamp x y z qx qy qz qw\n";
  for (const StampedPose& pose : poses) {
    const Eigen::Vector3d t = pose.T.translation();
    Eigen::Quaterniond q(pose.T.linear());
    if (q.w() < 0.0) q.coeffs() = -q.coeffs();
    file << std::fixed << std::setprecision(9) << pose.stamp_s << std::defaultfloat << std::setprecision(kPoseDigits);
    for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) file << ' ' << value;
    file << '\n';
  }
  finishWriting(file, path);
}

std::vector<double> readTimes(const std::string& path) {
  std::vector<double> times;
  forEachRow(path, false, [&](const std::string& text, const std::string& where) {
    const double time_s = parseNumbers(text, 1, where).front();
    if (!times.empty() && time_s < times.back()) throw InputError(where + "the time goes back");
    times.push_back(time_s);
  });
  requireRows(times.size(), path, "times");
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
