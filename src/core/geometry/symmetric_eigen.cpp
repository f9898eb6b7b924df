#include "core/geometry/symmetric_eigen.hpp"

namespace fail_aware {

Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> symmetricEigen(const Eigen::Matrix2d& C) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(C);
}

Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> symmetricEigen(const Eigen::Matrix3d& C) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(C);
}

Eigen::SelfAdjointEigenSolver<Matrix6d> symmetricEigen(const Matrix6d& C) {
  return Eigen::SelfAdjointEigenSolver<Matrix6d>(C);
}

Vector6d symmetricEigenvalues(const Matrix6d& C) {
  return Eigen::SelfAdjointEigenSolver<Matrix6d>(C, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace fail_aware
