// Are covariances true? Normalised estimation error squared (NEES) d^2 = e^T P^-1 e and what it should look like.
//
// With P true, d^2 / dof has mean 1, and of a horizontal error (2 dof) 39.3, 86.5 and 98.9 % lie within 1, 2 and 3
// sigma. Larger NEES: overconfident. Also for innovations (NIS), with the innovation covariance.
// Failure: no value where P is not positive definite or something is not finite.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/geometry/pose.hpp"

namespace fail_aware {

std::optional<double> normalisedErrorSquared(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance);

struct Consistency {
  std::size_t samples = 0;
  double mean_per_dof = 0.0;
  double median_over_expected = 0.0;     ///< median of d^2 over the chi-square median: outliers do not count
  std::array<double, 3> within_sigma{};  ///< share with d <= 1, 2, 3
};

/// Nothing for an empty list.
std::optional<Consistency> consistencyOf(const std::vector<double>& normalised_errors_squared, int dof);

/// The error of an estimated motion about the axes of its begin, in geometry/pose.hpp's covariance convention:
/// the truth is (t + dt, Exp(dr) R).
Vector6d motionError(const Pose& truth, const Pose& estimate);

}  // namespace fail_aware
