// What tests do to 6x6 matrices with Eigen's larger templates, compiled once.
#pragma once

#include <random>

#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"

namespace fail_aware {

Matrix6d inverseOf(const Matrix6d& A);

/// x of H x = b, H symmetric and positive definite.
Vector6d solutionOf(const Matrix6d& H, const Vector6d& b);

/// An orthogonal matrix, any direction as likely.
Matrix6d randomOrthogonal(std::mt19937& random);

}  // namespace fail_aware
