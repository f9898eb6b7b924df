#include "fail_aware_lidar_odometry/core/fusion/odometry_covariance.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "fail_aware_lidar_odometry/core/geometry/rotation.hpp"

namespace fail_aware {

namespace {

Matrix6d symmetric(const Matrix6d& C) { return 0.5 * C + 0.5 * C.transpose(); }

// The nearest positive semidefinite matrix.
Matrix6d positiveSemidefinite(const Matrix6d& C) {
  const Matrix6d S = symmetric(C);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(S);
  if (eigen.eigenvalues()[0] >= 0.0) return S;
  const Matrix6d half = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  return half * half.transpose();
}

bool isUsableInterval(double dt_s) { return std::isfinite(dt_s) && dt_s > 0.0; }

}  // namespace

bool OdometryCovariance::propagate(const Pose& T_odom_base_previous, const Pose& T_odom_base_now,
                                   const Matrix6d& increment_covariance) {
  if (!isFinite(T_odom_base_previous) || !isFinite(T_odom_base_now) || !increment_covariance.allFinite()) return false;
  const Matrix6d increment = positiveSemidefinite(increment_covariance);
  const Pose T_previous_now = T_odom_base_previous.inverse() * T_odom_base_now;

  const Matrix6d covariance = composeCovariance(covariance_, T_odom_base_previous, increment, T_previous_now);
  Matrix6d since_mark = Matrix6d::Zero();
  if (T_odom_mark_) {
    const Pose T_mark_previous = T_odom_mark_->inverse() * T_odom_base_previous;
    since_mark = composeCovariance(since_mark_, T_mark_previous, increment, T_previous_now);
  }
  if (!covariance.allFinite() || !since_mark.allFinite()) return false;
  covariance_ = symmetric(covariance);
  since_mark_ = symmetric(since_mark);
  return true;
}

void OdometryCovariance::reset(const Matrix6d& start_covariance) {
  covariance_ = start_covariance.allFinite() ? positiveSemidefinite(start_covariance) : Matrix6d::Zero();
  T_odom_mark_.reset();
  since_mark_.setZero();
}

void OdometryCovariance::mark(const Pose& T_odom_mark) {
  since_mark_.setZero();
  T_odom_mark_.reset();
  if (isFinite(T_odom_mark)) T_odom_mark_ = T_odom_mark;
}

std::optional<Vector6d> twistFromIncrement(const Pose& T_previous_now, double dt_s) {
  if (!isFinite(T_previous_now) || !isUsableInterval(dt_s)) return std::nullopt;
  const Vector6d twist = logSe3(T_previous_now) / dt_s;
  if (!twist.allFinite()) return std::nullopt;
  return twist;
}

std::optional<Matrix6d> twistCovariance(const Matrix6d& increment_covariance, const Pose& T_previous_now,
                                        double dt_s) {
  if (!increment_covariance.allFinite() || !isFinite(T_previous_now) || !isUsableInterval(dt_s)) return std::nullopt;
  // In the newest body's axes the error is a right factor, T Exp(e); log(T Exp(e)) = log(T) + J_r^-1 e with
  // J_r^-1 = I + ad/2 + ad^2/12 + O(ad^4).
  const Vector6d increment = logSe3(T_previous_now);
  Matrix6d ad = Matrix6d::Zero();
  ad.topLeftCorner<3, 3>() = ad.bottomRightCorner<3, 3>() = skew(increment.tail<3>());
  ad.topRightCorner<3, 3>() = skew(increment.head<3>());
  const Matrix6d J = Matrix6d::Identity() + 0.5 * ad + ad * ad / 12.0;
  const Matrix6d about_now =
      rotateCovariance(positiveSemidefinite(increment_covariance), T_previous_now.linear().transpose());
  const Matrix6d covariance = symmetric(J * about_now * J.transpose()) / (dt_s * dt_s);
  if (!covariance.allFinite()) return std::nullopt;
  return covariance;
}

}  // namespace fail_aware
