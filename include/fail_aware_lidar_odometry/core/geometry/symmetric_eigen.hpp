// Eigenvalues and eigenvectors of a covariance or information matrix. The one of a pose is compiled once: Eigen's solver
// of that size costs every source that names it seconds.
//
// C: symmetric, finite; its lower triangle is read. Eigenvalues ascend. Cost: ~2 us.
#pragma once

#include <Eigen/Eigenvalues>

#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"

namespace fail_aware {

Eigen::SelfAdjointEigenSolver<Matrix6d> symmetricEigen(const Matrix6d& C);

template <int N>
Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>> symmetricEigen(const Eigen::Matrix<double, N, N>& C) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>>(C);
}

/// The eigenvalues alone, in half the time.
Vector6d symmetricEigenvalues(const Matrix6d& C);

}  // namespace fail_aware
