// Eigenvalues and eigenvectors of a covariance or information matrix. The sizes 2, 3 and 6 are compiled once:
// Eigen's solvers add seconds to the compile time of each source that uses them.
//
// C: symmetric, finite; its lower triangle is read. Eigenvalues ascend. Cost of 6x6: ~2 us.
#pragma once

#include <Eigen/Eigenvalues>

#include "core/geometry/pose.hpp"

namespace fail_aware {

Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> symmetricEigen(const Eigen::Matrix2d& C);
Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> symmetricEigen(const Eigen::Matrix3d& C);
Eigen::SelfAdjointEigenSolver<Matrix6d> symmetricEigen(const Matrix6d& C);

/// C and its transpose, averaged.
template <class Matrix>
typename Matrix::PlainObject symmetric(const Matrix& C) {
  const typename Matrix::PlainObject& plain = C;  // an expression is evaluated once
  return 0.5 * plain + 0.5 * plain.transpose();
}

/// The eigenvalues only, in half the time. Of 2x2 by the closed formula (its upper triangle is read).
Vector6d symmetricEigenvalues(const Matrix6d& C);
Eigen::Vector2d symmetricEigenvalues(const Eigen::Matrix2d& C);

}  // namespace fail_aware
