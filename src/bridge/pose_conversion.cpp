#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"

#include "core/geometry/pose.hpp"

#include <cmath>

namespace fail_aware {

namespace {

using RowMajor6d = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

template <class Vector, class Quaternion>
std::optional<Pose> checkedPose(const Vector& position, const Quaternion& rotation) {
  const Eigen::Quaterniond q(rotation.w, rotation.x, rotation.y, rotation.z);
  const double norm = q.norm();
  if (!std::isfinite(norm) || std::abs(norm - 1.0) > 1e-3) return std::nullopt;
  const Pose T = poseOf(Eigen::Vector3d(position.x, position.y, position.z), q);
  if (!isFinite(T)) return std::nullopt;
  return T;
}

}  // namespace

geometry_msgs::Pose toPoseMessage(const Pose& T) {
  const Eigen::Quaterniond q = quaternionOf(T);
  geometry_msgs::Pose message;
  message.position.x = T.translation().x();
  message.position.y = T.translation().y();
  message.position.z = T.translation().z();
  message.orientation.x = q.x();
  message.orientation.y = q.y();
  message.orientation.z = q.z();
  message.orientation.w = q.w();
  return message;
}

geometry_msgs::Transform toTransformMessage(const Pose& T) {
  const geometry_msgs::Pose pose = toPoseMessage(T);
  geometry_msgs::Transform message;
  message.translation.x = pose.position.x;
  message.translation.y = pose.position.y;
  message.translation.z = pose.position.z;
  message.rotation = pose.orientation;
  return message;
}

std::optional<Pose> fromMessage(const geometry_msgs::Pose& message) {
  return checkedPose(message.position, message.orientation);
}

std::optional<Pose> fromMessage(const geometry_msgs::Transform& message) {
  return checkedPose(message.translation, message.rotation);
}

CovarianceMessage toCovarianceMessage(const Matrix6d& covariance) {
  CovarianceMessage message;
  Eigen::Map<RowMajor6d>(message.data()) = covariance;
  return message;
}

Matrix6d fromMessage(const CovarianceMessage& message) { return Eigen::Map<const RowMajor6d>(message.data()); }

}  // namespace fail_aware
