#include "evaluation/consistency.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "evaluation/quantile.hpp"

namespace fail_aware {

std::optional<double> normalisedErrorSquared(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance) {
  if (!error.allFinite() || !covariance.allFinite()) return std::nullopt;
  const Eigen::LLT<Eigen::MatrixXd> llt(0.5 * (covariance + covariance.transpose()));
  if (llt.info() != Eigen::Success) return std::nullopt;
  const double squared = llt.matrixL().solve(error).squaredNorm();
  if (!std::isfinite(squared)) return std::nullopt;
  return squared;
}

std::optional<Consistency> consistencyOf(const std::vector<double>& normalised_errors_squared, int dof) {
  if (normalised_errors_squared.empty()) return std::nullopt;
  Consistency result;
  result.samples = normalised_errors_squared.size();
  const auto count = static_cast<double>(result.samples);
  for (const double squared : normalised_errors_squared) {
    result.mean_per_dof += squared / dof / count;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto sigmas = static_cast<double>(k + 1);
      if (squared <= sigmas * sigmas) result.within_sigma[k] += 1.0 / count;
    }
  }
  // Wilson and Hilferty's approximation, within 1.4 % from 2 dof on.
  const double chi_square_median = dof * std::pow(1.0 - 2.0 / (9.0 * dof), 3);
  result.median_over_expected = quantile(normalised_errors_squared, 0.5) / chi_square_median;
  return result;
}

Vector6d motionError(const Pose& truth, const Pose& estimate) {
  Vector6d error;
  error.head<3>() = truth.translation() - estimate.translation();
  const Eigen::AngleAxisd rotation(Eigen::Matrix3d(truth.linear() * estimate.linear().transpose()));
  error.tail<3>() = rotation.angle() * rotation.axis();
  return error;
}

}  // namespace fail_aware
