#include "core/geometry/symmetric_eigen.hpp"

#include <cmath>

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

Eigen::Vector2d symmetricEigenvalues(const Eigen::Matrix2d& C) {
  const double mean = 0.5 * C.trace(), spread = std::hypot(0.5 * (C(0, 0) - C(1, 1)), C(0, 1));
  return {mean - spread, mean + spread};
}

}  // namespace fail_aware
