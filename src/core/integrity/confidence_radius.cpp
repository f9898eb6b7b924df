#include "core/integrity/confidence_radius.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/decompositions.hpp"

namespace fail_aware {

namespace {

// Of a circle with scale 1, of the squared radius.
double circleExceedance(double squared, double degrees_of_freedom) {
  return degrees_of_freedom > 0.0 ? std::pow(1.0 + squared / degrees_of_freedom, -0.5 * degrees_of_freedom)
                                  : std::exp(-0.5 * squared);
}

// Probability that an error with scales 1 and `ratio` is farther than `radius`. The integrand has period pi and is
// symmetric about pi / 2.
double exceedance(double ratio, double radius, double degrees_of_freedom) {
  constexpr int kSteps = 64;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double sine = std::sin(0.5 * M_PI * (i + 0.5) / kSteps);
    sum += circleExceedance(radius * radius / (1.0 - (1.0 - ratio * ratio) * sine * sine), degrees_of_freedom);
  }
  return sum / kSteps;
}

// Standard deviations along the axes, the larger first.
Eigen::Vector2d axesOf(const Eigen::Matrix2d& covariance) {
  const Eigen::Vector2d variances = symmetricEigenvalues(covariance);
  return Eigen::Vector2d(std::max(variances[1], 0.0), std::max(variances[0], 0.0)).cwiseSqrt();
}

}  // namespace

ConfidenceRadius::ConfidenceRadius(double probability, double degrees_of_freedom) {
  const double n = degrees_of_freedom;
  const double circle = n > 0.0 ? std::sqrt(n * (std::pow(1.0 - probability, -2.0 / n) - 1.0))
                                : std::sqrt(-2.0 * std::log1p(-probability));  // the largest
  for (int i = 0; i <= kTable; ++i) {
    const double ratio = static_cast<double>(i) / kTable;
    const auto inside = [&](double radius) { return exceedance(ratio, radius, n) > 1.0 - probability; };
    sigmas_[static_cast<std::size_t>(i)] = endOf(inside, circle * (1.0 + 1e-9));
  }
}

double ConfidenceRadius::operator()(const Eigen::Matrix2d& covariance) const {
  const Eigen::Vector2d sigmas = axesOf(covariance);
  if (sigmas[0] <= 0.0) return 0.0;
  const double place = std::min(sigmas[1] / sigmas[0], 1.0) * kTable;
  const auto below = std::min(static_cast<std::size_t>(place), static_cast<std::size_t>(kTable - 1));
  const double share = place - static_cast<double>(below);
  return ((1.0 - share) * sigmas_[below] + share * sigmas_[below + 1]) * sigmas[0];
}

double exceedance(const Eigen::Matrix2d& covariance, double radius, double degrees_of_freedom) {
  const Eigen::Vector2d sigmas = axesOf(covariance);
  if (sigmas[0] <= 0.0) return 0.0;
  return exceedance(std::min(sigmas[1] / sigmas[0], 1.0), radius / sigmas[0], degrees_of_freedom);
}

double exceedanceBound(const Eigen::Matrix2d& covariance, double radius, double degrees_of_freedom) {
  constexpr double kRounding = 1.0 + 1e-12;
  const double sigma = axesOf(covariance)[0];
  if (sigma <= 0.0) return 0.0;
  return kRounding * circleExceedance(radius * radius / (sigma * sigma), degrees_of_freedom);
}

}  // namespace fail_aware
