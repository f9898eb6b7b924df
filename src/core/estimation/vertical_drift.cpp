#include "core/estimation/vertical_drift.hpp"

#include <algorithm>
#include <cmath>

namespace fail_aware {

void VerticalDrift::advance(const Eigen::Vector3d& step_odom, const std::optional<Eigen::Matrix2d>& tilt_moment) {
  if (tilt_moment && tilt_moment->allFinite()) tilt_moment_ = 0.5 * (*tilt_moment + tilt_moment->transpose());
  const Eigen::Vector2d v(step_odom.y(), -step_odom.x());
  sigma_height_m_ += std::sqrt(std::max(v.dot(tilt_moment_ * v), 0.0));
}

Matrix6d VerticalDrift::covariance() const {
  Matrix6d C = Matrix6d::Zero();
  C(2, 2) = sigma_height_m_ * sigma_height_m_;
  C.block<2, 2>(3, 3) = tilt_moment_;
  return C;
}

}  // namespace fail_aware
