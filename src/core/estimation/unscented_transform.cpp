#include "core/estimation/unscented_transform.hpp"

#include "core/geometry/rotation.hpp"

namespace fail_aware {

UnscentedWeights unscentedWeights(const UnscentedParams& params, int dimension) {
  const double scale = params.alpha * params.alpha * (dimension + params.kappa);  // N + lambda
  UnscentedWeights weights;
  weights.spread = std::sqrt(scale);
  weights.mean_centre = (scale - dimension) / scale;
  weights.covariance_centre = weights.mean_centre + 1.0 - params.alpha * params.alpha + params.beta;
  weights.other = 0.5 / scale;
  return weights;
}

Vector6d PoseStateSpace::difference(const Vector6d& a, const Vector6d& b) { return stateDifference(a, b); }

Vector6d PoseStateSpace::sum(const Vector6d& a, const Vector6d& step) {
  Vector6d out = a + step;
  for (int i = 3; i < 6; ++i) out[i] = wrapAngle(out[i]);
  return out;
}

}  // namespace fail_aware
