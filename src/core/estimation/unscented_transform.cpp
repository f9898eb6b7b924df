#include "core/estimation/unscented_transform.hpp"

#include <cmath>
#include <cstddef>

#include "core/geometry/rotation.hpp"
#include "core/geometry/symmetric_eigen.hpp"

namespace fail_aware {

UnscentedWeights unscentedWeights() {
  constexpr double kDimension = 6.0;
  constexpr double kAlpha = 0.1;  // spread of the sigma points, more local towards 0; 0.1 keeps the weights accurate
  constexpr double kBeta = 2.0;   // suits Gaussian distributions
  const double scale = kAlpha * kAlpha * kDimension;  // N + lambda
  UnscentedWeights weights;
  weights.spread = std::sqrt(scale);
  weights.mean_centre = (scale - kDimension) / scale;
  weights.covariance_centre = weights.mean_centre + 1.0 - kAlpha * kAlpha + kBeta;
  weights.other = 0.5 / scale;
  return weights;
}

Vector6d stateSum(const Vector6d& a, const Vector6d& step) {
  Vector6d out = a + step;
  for (int i = 3; i < 6; ++i) out[i] = wrapAngle(out[i]);
  return out;
}

Matrix6d symmetricSquareRoot(const Matrix6d& C) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen = symmetricEigen(symmetric(C));
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose();
}

SigmaPoints sigmaPoints(const Vector6d& mean, const Matrix6d& covariance, const UnscentedWeights& weights) {
  const Matrix6d offsets = weights.spread * symmetricSquareRoot(covariance);
  SigmaPoints points;
  points[0] = mean;
  for (int i = 0; i < 6; ++i) {
    const Vector6d offset = offsets.col(i);
    points[static_cast<std::size_t>(1 + i)] = stateSum(mean, offset);
    points[static_cast<std::size_t>(7 + i)] = stateSum(mean, -offset);
  }
  return points;
}

void unscentedMoments(const SigmaPoints& points, const UnscentedWeights& weights, Vector6d& mean,
                      Matrix6d& covariance) {
  Vector6d step = Vector6d::Zero();
  for (std::size_t i = 1; i < points.size(); ++i) step += weights.other * stateDifference(points[i], points[0]);
  mean = stateSum(points[0], step);

  const Vector6d centre = stateDifference(points[0], mean);
  covariance = weights.covariance_centre * centre * centre.transpose();
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vector6d d = stateDifference(points[i], mean);
    covariance += weights.other * d * d.transpose();
  }
}

}  // namespace fail_aware
