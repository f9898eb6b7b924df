#include "core/geometry/decompositions.hpp"

#include <Eigen/Dense>
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

Matrix6d positiveSemidefinite(const Matrix6d& C) {
  Matrix6d S = symmetric(C);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen = symmetricEigen(S);
  if (eigen.eigenvalues()[0] >= 0.0) return S;
  const Matrix6d half = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  return half * half.transpose();
}

Matrix6d inverseOf(const Matrix6d& A) { return A.inverse(); }

Vector6d solutionOf(const Matrix6d& H, const Vector6d& b) { return H.ldlt().solve(b); }

Matrix6d solutionOf(const Matrix6d& H, const Matrix6d& B) { return H.ldlt().solve(B); }

}  // namespace fail_aware
