#include "core/io/external_pose_file.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/geometry/pose.hpp"
#include "core/io/number_table.hpp"

namespace fail_aware {

namespace {

struct ExternalPoseRow {
  double stamp_s = 0.0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector4d quaternion = Eigen::Vector4d::Zero();  ///< x y z w
  Vector6d sigmas = Vector6d::Zero();
};

struct ExternalPoseTable {
  using Row = ExternalPoseRow;
  static constexpr const char* kName = "poses";
  static constexpr const char* kRemedy =
      "stamp,x,y,z,qx,qy,qz,qw,sigma_x,sigma_y,sigma_z,sigma_roll,sigma_pitch,sigma_yaw";

  template <class Self, class Visitor>
  static void visit(Self& row, Visitor&& v) {
    v("stamp", row.stamp_s);
    const char* const axes[] = {"x", "y", "z"};
    for (int i = 0; i < 3; ++i) v(axes[i], row.position_m[i]);
    const char* const parts[] = {"qx", "qy", "qz", "qw"};
    for (int i = 0; i < 4; ++i) v(parts[i], row.quaternion[i]);
    const char* const sigmas[] = {"sigma_x", "sigma_y", "sigma_z", "sigma_roll", "sigma_pitch", "sigma_yaw"};
    for (int i = 0; i < 6; ++i) v(sigmas[i], row.sigmas[i]);
  }
};

constexpr double kUnitTolerance = 1e-3;

}  // namespace

std::vector<ExternalPose> readExternalPoses(const std::string& path) {
  std::vector<ExternalPose> poses;
  for (const ExternalPoseRow& row : readNumberTable<ExternalPoseTable>(path)) {
    const std::string at = path + ": stamp " + std::to_string(row.stamp_s) + ": ";
    if (!std::isfinite(row.stamp_s)) throw InputError(at + "must be finite");
    if (!(std::abs(row.quaternion.norm() - 1.0) <= kUnitTolerance))
      throw InputError(at + "qx..qw is not a unit quaternion");
    if (!(row.sigmas.array() >= 0.0).all()) throw InputError(at + "a sigma is negative or not a number");
    ExternalPose pose;
    pose.stamp_s = row.stamp_s;
    pose.T_odom_base.translation() = row.position_m;
    pose.T_odom_base.linear() = Eigen::Quaterniond(row.quaternion).normalized().toRotationMatrix();
    pose.covariance = row.sigmas.cwiseAbs2().asDiagonal();
    poses.push_back(pose);
  }
  std::stable_sort(poses.begin(), poses.end(),
                   [](const ExternalPose& a, const ExternalPose& b) { return a.stamp_s < b.stamp_s; });
  return poses;
}

}  // namespace fail_aware
