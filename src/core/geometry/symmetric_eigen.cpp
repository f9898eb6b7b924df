#include "fail_aware_lidar_odometry/core/geometry/symmetric_eigen.hpp"

namespace fail_aware {

Eigen::SelfAdjointEigenSolver<Matrix6d> symmetricEigen(const Matrix6d& C) {
  return Eigen::SelfAdjointEigenSolver<Matrix6d>(C);
}

Vector6d symmetricEigenvalues(const Matrix6d& C) {
  return Eigen::SelfAdjointEigenSolver<Matrix6d>(C, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace fail_aware
