#include "core/estimation/unscented_transform.hpp"

#include <cmath>
#include <cstddef>

#include "core/geometry/decompositions.hpp"

namespace fail_aware {

namespace {

constexpr double kDimension = 6.0;
constexpr double kAlpha = 0.1;  // spread of the sigma points, more local towards 0; 0.1 keeps the weights accurate
constexpr double kBeta = 2.0;   // suits Gaussian distributions
constexpr double kScale = kAlpha * kAlpha * kDimension;                                               // N + lambda
constexpr double kCovarianceWeight = (kScale - kDimension) / kScale + 1.0 - kAlpha * kAlpha + kBeta;  // of the mean
constexpr double kWeight = 0.5 / kScale;  // of every other point, in mean and covariance

}  // namespace

Matrix6d symmetricSquareRoot(const Matrix6d& C) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen = symmetricEigen(symmetric(C));
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose();
}

SigmaPoints sigmaPoints(const Vector6d& mean, const Matrix6d& covariance) {
  const Matrix6d offsets = std::sqrt(kScale) * symmetricSquareRoot(covariance);
  SigmaPoints points;
  points[0] = mean;
  for (int i = 0; i < 6; ++i) {
    const Vector6d offset = offsets.col(i);
    points[static_cast<std::size_t>(1 + i)] = stateSum(mean, offset);
    points[static_cast<std::size_t>(7 + i)] = stateSum(mean, -offset);
  }
  return points;
}

void unscentedMoments(const SigmaPoints& points, Vector6d& mean, Matrix6d& covariance) {
  Vector6d step = Vector6d::Zero();
  for (std::size_t i = 1; i < points.size(); ++i) step += kWeight * stateDifference(points[i], points[0]);
  mean = stateSum(points[0], step);

  const Vector6d centre = stateDifference(points[0], mean);
  covariance = kCovarianceWeight * centre * centre.transpose();
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vector6d d = stateDifference(points[i], mean);
    covariance += kWeight * d * d.transpose();
  }
}

}  // namespace fail_aware
