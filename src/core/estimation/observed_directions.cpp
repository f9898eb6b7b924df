#include "core/estimation/observed_directions.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/decompositions.hpp"

namespace fail_aware {

void openUnobserved(const ObservedLimit& limit, Eigen::Ref<Eigen::Matrix3d> block) {
  constexpr double kOpen = 1e6;  // a variance; with a larger one the inverse would lose the other directions' digits
  const auto eigen = symmetricEigen(Eigen::Matrix3d(block));
  for (int i = 0; i < 3; ++i) {
    const double variance = eigen.eigenvalues()[i], sigma = std::sqrt(std::max(variance, 0.0));
    const double open = std::clamp((sigma - limit.surely) / (limit.hardly - limit.surely), 0.0, 1.0);
    if (open == 0.0) continue;
    const double left = open < 1.0 ? std::min(variance / (1.0 - open), kOpen) : kOpen;
    const Eigen::Vector3d axis = eigen.eigenvectors().col(i);
    block += std::max(left - variance, 0.0) * axis * axis.transpose();
  }
}

Matrix6d covarianceForFilter(const FusionResult& fusion, const std::vector<FusionInput>& inputs) {
  Matrix6d R = fusion.R;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (inputs[i].kind == FusionInput::Kind::kExternal && fusion.weights[i] > 0.0) return R;
  }
  openUnobserved({1.0, 2.0}, R.topLeftCorner<3, 3>());
  return R;
}

}  // namespace fail_aware
