#include "core/geometry/rotation.hpp"

#include <cmath>

namespace fail_aware {

double wrapAngle(double angle_rad) {
  if (angle_rad >= -M_PI && angle_rad < M_PI) return angle_rad;
  if (!std::isfinite(angle_rad)) return angle_rad;
  const double wrapped = std::remainder(angle_rad, 2.0 * M_PI);
  return wrapped >= M_PI ? wrapped - 2.0 * M_PI : wrapped;
}

Eigen::Matrix3d rotationFromRpy(double roll_rad, double pitch_rad, double yaw_rad) {
  const double cr = std::cos(roll_rad), sr = std::sin(roll_rad);
  const double cp = std::cos(pitch_rad), sp = std::sin(pitch_rad);
  const double cy = std::cos(yaw_rad), sy = std::sin(yaw_rad);
  Eigen::Matrix3d R;
  R << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,   //
      -sp, cp * sr, cp * cr;
  return R;
}

Eigen::Vector3d rpyFromRotation(const Eigen::Matrix3d& R) {
  const double cp = std::hypot(R(0, 0), R(1, 0));
  if (cp < 1e-9) return {0.0, std::atan2(-R(2, 0), cp), std::atan2(-R(0, 1), R(1, 1))};
  return {std::atan2(R(2, 1), R(2, 2)), std::atan2(-R(2, 0), cp), std::atan2(R(1, 0), R(0, 0))};
}

Eigen::Matrix3d skew(const Eigen::Vector3d& w) {
  Eigen::Matrix3d S;
  S << 0.0, -w.z(), w.y(), w.z(), 0.0, -w.x(), -w.y(), w.x(), 0.0;
  return S;
}

Eigen::Matrix3d expSo3(const Eigen::Vector3d& rotation_vector) {
  const double theta2 = rotation_vector.squaredNorm();
  const Eigen::Matrix3d W = skew(rotation_vector);
  double a, b;  // sin(t)/t, (1 - cos t)/t^2
  if (theta2 < 1e-8) {
    a = 1.0 - theta2 / 6.0;
    b = 0.5 - theta2 / 24.0;
  } else {
    const double theta = std::sqrt(theta2);
    a = std::sin(theta) / theta;
    b = (1.0 - std::cos(theta)) / theta2;
  }
  return Eigen::Matrix3d::Identity() + a * W + b * W * W;
}

Eigen::Vector3d logSo3(const Eigen::Matrix3d& R) {
  Eigen::Quaterniond q(R);
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const double s = q.vec().norm();
  if (s < 1e-10) return 2.0 * q.vec();
  return (2.0 * std::atan2(s, q.w()) / s) * q.vec();
}

Eigen::Matrix3d fixedAxisFromRpyRates(const Eigen::Vector3d& rpy_rad) {
  const double cp = std::cos(rpy_rad.y()), sp = std::sin(rpy_rad.y());
  const double cy = std::cos(rpy_rad.z()), sy = std::sin(rpy_rad.z());
  Eigen::Matrix3d J;
  J << cy * cp, -sy, 0.0, sy * cp, cy, 0.0, -sp, 0.0, 1.0;
  return J;
}

}  // namespace fail_aware
