// Decompositions of small matrices, compiled once: Eigen's solvers add seconds to the compile time of each source that
// uses them.
#pragma once

#include <Eigen/Eigenvalues>

#include "core/geometry/pose.hpp"

namespace fail_aware {

/// Eigenvalues, ascending, and eigenvectors. C: symmetric, finite; its lower triangle is read. 6x6: ~2 us.
Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> symmetricEigen(const Eigen::Matrix2d& C);
Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> symmetricEigen(const Eigen::Matrix3d& C);
Eigen::SelfAdjointEigenSolver<Matrix6d> symmetricEigen(const Matrix6d& C);

/// The eigenvalues only, in half the time. Of 2x2 by the closed formula (its upper triangle is read).
Vector6d symmetricEigenvalues(const Matrix6d& C);
Eigen::Vector2d symmetricEigenvalues(const Eigen::Matrix2d& C);

/// C and its transpose, averaged.
template <class Matrix>
typename Matrix::PlainObject symmetric(const Matrix& C) {
  const typename Matrix::PlainObject& plain = C;  // an expression is evaluated once
  return 0.5 * plain + 0.5 * plain.transpose();
}

/// The nearest positive semidefinite matrix to C, symmetrized.
Matrix6d positiveSemidefinite(const Matrix6d& C);

/// By LU with partial pivoting; the result is not finite if A is singular.
Matrix6d inverseOf(const Matrix6d& A);

/// Solves H x = b by LDL^T with pivoting; H symmetric, positive semidefinite, its lower triangle is read.
Vector6d solutionOf(const Matrix6d& H, const Vector6d& b);
Matrix6d solutionOf(const Matrix6d& H, const Matrix6d& B);

}  // namespace fail_aware
