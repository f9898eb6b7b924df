#include "core/geometry/pose.hpp"

#include <cmath>

#include "core/geometry/rotation.hpp"

namespace fail_aware {

namespace {

constexpr int kHorizontal[] = {0, 1, 5};  // x, y, yaw

// V with t = V rho for SE(3): V = I + b W + c W^2, b = (1 - cos t)/t^2, c = (t - sin t)/t^3.
Eigen::Matrix3d leftJacobianSo3(const Eigen::Vector3d& w) {
  const double theta2 = w.squaredNorm();
  const Eigen::Matrix3d W = skew(w);
  double b, c;
  if (theta2 < 1e-8) {
    b = 0.5 - theta2 / 24.0;
    c = 1.0 / 6.0 - theta2 / 120.0;
  } else {
    const double theta = std::sqrt(theta2);
    b = (1.0 - std::cos(theta)) / theta2;
    c = (theta - std::sin(theta)) / (theta2 * theta);
  }
  return Eigen::Matrix3d::Identity() + b * W + c * W * W;
}

}  // namespace

Pose expSe3(const Vector6d& twist) {
  Pose T = Pose::Identity();
  const Eigen::Vector3d w = twist.tail<3>();
  T.linear() = expSo3(w);
  T.translation() = leftJacobianSo3(w) * twist.head<3>();
  return T;
}

Vector6d logSe3(const Pose& T) {
  Vector6d twist;
  const Eigen::Vector3d w = logSo3(T.linear());
  twist.tail<3>() = w;
  twist.head<3>() = leftJacobianSo3(w).inverse() * T.translation();
  return twist;
}

Pose poseFromVector(const Vector6d& v) {
  Pose T = Pose::Identity();
  T.translation() = v.head<3>();
  T.linear() = rotationFromRpy(v[3], v[4], v[5]);
  return T;
}

Vector6d vectorFromPose(const Pose& T) {
  Vector6d v;
  v.head<3>() = T.translation();
  v.tail<3>() = rpyFromRotation(T.linear());
  return v;
}

Vector6d wrapAngles(const Vector6d& state) {
  Vector6d wrapped = state;
  for (int i = 3; i < 6; ++i) wrapped[i] = wrapAngle(state[i]);
  return wrapped;
}

Vector6d stateSum(const Vector6d& a, const Vector6d& b) { return wrapAngles(a + b); }
Vector6d stateDifference(const Vector6d& a, const Vector6d& b) { return wrapAngles(a - b); }

Matrix6d poseFromStateJacobian(const Eigen::Vector3d& rpy_rad) {
  Matrix6d J = Matrix6d::Identity();
  J.bottomRightCorner<3, 3>() = fixedAxisFromRpyRates(rpy_rad);
  return J;
}

Matrix6d poseCovarianceFromState(const Matrix6d& state_covariance, const Vector6d& state) {
  const Matrix6d J = poseFromStateJacobian(state.tail<3>());
  return J * state_covariance * J.transpose();
}

Matrix6d covarianceAfterOffset(const Matrix6d& covariance_ab, const Pose& T_a_b, const Pose& T_b_c) {
  // t_ac = t_ab + R_ab t_bc, so dt_ac = dt_ab + dr x (R_ab t_bc)
  Matrix6d A = Matrix6d::Identity();
  A.topRightCorner<3, 3>() = -skew(T_a_b.linear() * T_b_c.translation());
  return A * covariance_ab * A.transpose();
}

Matrix6d rotateCovariance(const Matrix6d& covariance, const Eigen::Matrix3d& R) {
  Matrix6d A = Matrix6d::Zero();
  A.topLeftCorner<3, 3>() = R;
  A.bottomRightCorner<3, 3>() = R;
  return A * covariance * A.transpose();
}

Eigen::Matrix3d horizontalBlock(const Matrix6d& covariance) {
  Eigen::Matrix3d block;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) block(i, j) = covariance(kHorizontal[i], kHorizontal[j]);
  }
  return block;
}

void setHorizontalBlock(const Eigen::Matrix3d& block, Matrix6d& covariance) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) covariance(kHorizontal[i], kHorizontal[j]) = block(i, j);
  }
}

Matrix6d isotropicCovariance(double sigma_m, double sigma_rad) {
  Vector6d sigmas;
  sigmas << Eigen::Vector3d::Constant(sigma_m), Eigen::Vector3d::Constant(sigma_rad);
  return sigmas.cwiseAbs2().asDiagonal();
}

Pose orthonormalized(const Pose& T) {
  Pose out = T;
  out.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
  return out;
}

bool isFinite(const Pose& T) { return T.matrix().allFinite(); }

Eigen::Quaterniond quaternionOf(const Pose& T) {
  Eigen::Quaterniond q(T.linear());
  q.normalize();
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  return q;
}

Pose poseOf(const Eigen::Vector3d& position, const Eigen::Quaterniond& rotation) {
  Pose T = Pose::Identity();
  T.translation() = position;
  T.linear() = rotation.normalized().toRotationMatrix();
  return T;
}

Pose quaternionRoundTrip(const Pose& T) { return poseOf(T.translation(), quaternionOf(T)); }

}  // namespace fail_aware
