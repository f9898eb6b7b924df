// The circle that holds a horizontal error with a given probability, and the probability beyond a radius (not in the
// paper).
//
// The error (x, y) is Student's t with the covariance as its scale and `degrees_of_freedom` n: most drives err less
// than a Gaussian of the same tails would, some a lot more. With scales a >= b along its axes and c = 1 - b/a it is
// within r with
//   p = 1 - 1/(2 pi) integral over phi of (1 + r^2 / (n a (1 - c sin^2 phi)))^(-n/2),
// for a Gaussian (n infinite; here 0) of exp(-r^2 / (2 a (1 - c sin^2 phi))): from a circle's sqrt(-2 ln(1 - p)) sigma
// down to a normal's two-sided quantile for a line. `ConfidenceRadius` gives that r.
// Units: m. Cost: a radius is read from a table, a probability is a sum of 64 terms, its bound one.
#pragma once

#include <Eigen/Core>
#include <array>

namespace fail_aware {

class ConfidenceRadius {
 public:
  /// probability in (0, 1); degrees_of_freedom 0: Gaussian.
  explicit ConfidenceRadius(double probability, double degrees_of_freedom = 0.0);
  double operator()(const Eigen::Matrix2d& covariance) const;

 private:
  static constexpr int kTable = 64;
  std::array<double, kTable + 1> sigmas_{};  ///< by the ratio of the smaller sigma to the larger
};

/// The value between 0 and `high` up to which `below` is true, by bisection: the upper end of the last interval.
template <class Below>
double endOf(const Below& below, double high) {
  double low = 0.0;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (below(middle) ? low : high) = middle;
  }
  return high;
}

/// Probability that a horizontal error is farther than `radius`.
double exceedance(const Eigen::Matrix2d& covariance, double radius, double degrees_of_freedom = 0.0);

/// At least exceedance(), at a small part of its cost: that of the circle around the covariance.
double exceedanceBound(const Eigen::Matrix2d& covariance, double radius, double degrees_of_freedom = 0.0);

}  // namespace fail_aware
