// What goes into the odometry: a sweep (one revolution of a spinning lidar, as it came from the driver or a file), and
// poses from elsewhere. Points: m, sensor frame.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace fail_aware {

using Pose = Eigen::Isometry3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// False: not finite, zero (no return), or farther than any lidar sees. Squares and rotations of usable points stay
/// finite.
inline bool isUsablePoint(const Eigen::Vector3f& point_m) {
  constexpr float kFarthest_m = 1e6f;
  return point_m.allFinite() && point_m.cwiseAbs().maxCoeff() <= kFarthest_m && !point_m.isZero(0.0f);
}

/// What is known of the field that a sweep's `times_s` come from (preprocessing/point_times.hpp). The default is that
/// of times that are s from some instant of the sweep.
struct TimeFieldSource {
  std::string name;        ///< in the driver's cloud; empty: it has none, or the sweep comes from no cloud
  const char* unit = "s";  ///< in which its numbers were read
  double origin_s = 0.0;   ///< on the field's clock: where `times_s` count from
  std::string refused;     ///< why its numbers are no times of a sweep; empty: they are. If refused: no `times_s`
};

/// A sweep's points. `points_lidar` (m, sensor frame) is always there and finite; the other arrays are empty or as
/// long as `points_lidar`.
struct Sweep {
  double stamp_s = 0.0;                       ///< header stamp, s; its instant: sweep timing's `stamp_reference`
  std::vector<Eigen::Vector3f> points_lidar;  ///< m
  std::vector<float> intensities;             ///< sensor units
  std::vector<float> times_s;                 ///< as the driver gave them, s from `time_field.origin_s`; may hold NaN
  std::vector<std::uint16_t> rings;           ///< laser number, 0 = lowest beam
  TimeFieldSource time_field;                 ///< of `times_s`
  std::size_t points_dropped = 0;             ///< of the source that are not usable, left out here

  std::size_t size() const { return points_lidar.size(); }
  bool empty() const { return points_lidar.empty(); }
};

/// A pose from elsewhere (GPS, visual odometry, set_pose) with a stamp of its own. Not in the paper. The covariance is
/// in result.hpp's convention (m, rad); a rotation block that is all zero: not measured.
struct ExternalPose {
  double stamp_s = 0.0;
  Eigen::Isometry3d T_odom_base = Eigen::Isometry3d::Identity();
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

}  // namespace fail_aware
