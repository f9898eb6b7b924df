#include "random_orthogonal.hpp"

#include <Eigen/QR>

namespace fail_aware {

Matrix6d randomOrthogonal(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Matrix6d A;
  for (int i = 0; i < 36; ++i) A(i / 6, i % 6) = normal(random);
  return Eigen::HouseholderQR<Matrix6d>(A).householderQ();
}

}  // namespace fail_aware
