// Inverse and solution of 6x6 systems, compiled once: Eigen's decompositions add seconds to the compile time of each
// source that uses them.
#pragma once

#include "core/geometry/pose.hpp"

namespace fail_aware {

/// By LU with partial pivoting; the result is not finite if A is singular.
Matrix6d inverseOf(const Matrix6d& A);

/// Solves H x = b by LDL^T with pivoting; H symmetric, positive semidefinite, its lower triangle is read.
Vector6d solutionOf(const Matrix6d& H, const Vector6d& b);
Matrix6d solutionOf(const Matrix6d& H, const Matrix6d& B);

}  // namespace fail_aware
