// Merwe's scaled sigma points and their mean and covariance (paper, section "Vehicle Pose Estimation System").
//
// 2N + 1 points: the mean, and mean +- sqrt(N + lambda) times the columns of the covariance's symmetric square root,
// lambda = alpha^2 (N + kappa) - N. The symmetric root exists for semi-definite covariances and changes continuously
// when they rotate. Mean and difference are hooks, so that angles wrap. The mean is formed from differences to the
// first point: this is the circular mean for points less than half a turn from it, and it stays accurate when the
// weights are large and of both signs (small alpha).
// Failure: none for finite input; negative eigenvalues count as 0. Cost: one eigendecomposition.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/geometry/pose.hpp"
#include "core/geometry/symmetric_eigen.hpp"

namespace fail_aware {

struct UnscentedParams {
  /// spread of the sigma points, more local towards 0; 0.1 keeps the weights accurate
  double alpha = 0.1;
  double beta = 2.0;   ///< 2 suits Gaussian distributions
  double kappa = 0.0;  ///< N + kappa > 0: 0 is the usual choice
};

struct UnscentedWeights {
  double spread = 0.0;  ///< sqrt(N + lambda)
  double mean_centre = 0.0;
  double covariance_centre = 0.0;
  double other = 0.0;  ///< weight of every other point, in mean and covariance
};

UnscentedWeights unscentedWeights(const UnscentedParams& params, int dimension);

/// Differences and sums of plain vectors.
struct EuclideanSpace {
  template <class Vector>
  static Vector difference(const Vector& a, const Vector& b) {
    return a - b;
  }
  template <class Vector>
  static Vector sum(const Vector& a, const Vector& step) {
    return a + step;
  }
};

/// States (x, y, z, roll, pitch, yaw): the last three wrap.
struct PoseStateSpace {
  static Vector6d difference(const Vector6d& a, const Vector6d& b);
  static Vector6d sum(const Vector6d& a, const Vector6d& step);
};

template <int N>
using SigmaPoints = std::array<Eigen::Matrix<double, N, 1>, static_cast<std::size_t>(2 * N + 1)>;

/// Symmetric S with S S = C (C symmetric; eigenvalues below 0 count as 0).
template <int N>
Eigen::Matrix<double, N, N> symmetricSquareRoot(const Eigen::Matrix<double, N, N>& C) {
  const Eigen::Matrix<double, N, N> symmetric = 0.5 * (C + C.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>> eigen = symmetricEigen(symmetric);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose();
}

/// Point 0 is the mean, 1..N the positive side, N+1..2N the negative side.
template <class Space, int N>
SigmaPoints<N> sigmaPoints(const Eigen::Matrix<double, N, 1>& mean, const Eigen::Matrix<double, N, N>& covariance,
                           const UnscentedWeights& weights) {
  const Eigen::Matrix<double, N, N> offsets = weights.spread * symmetricSquareRoot<N>(covariance);
  SigmaPoints<N> points;
  points[0] = mean;
  for (int i = 0; i < N; ++i) {
    const Eigen::Matrix<double, N, 1> offset = offsets.col(i);
    points[static_cast<std::size_t>(1 + i)] = Space::sum(mean, offset);
    points[static_cast<std::size_t>(1 + N + i)] = Space::sum(mean, Eigen::Matrix<double, N, 1>(-offset));
  }
  return points;
}

template <class Space, int N>
void unscentedMoments(const SigmaPoints<N>& points, const UnscentedWeights& weights, Eigen::Matrix<double, N, 1>& mean,
                      Eigen::Matrix<double, N, N>& covariance) {
  Eigen::Matrix<double, N, 1> step = Eigen::Matrix<double, N, 1>::Zero();
  for (std::size_t i = 1; i < points.size(); ++i) step += weights.other * Space::difference(points[i], points[0]);
  mean = Space::sum(points[0], step);

  const Eigen::Matrix<double, N, 1> centre = Space::difference(points[0], mean);
  covariance = weights.covariance_centre * centre * centre.transpose();
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Eigen::Matrix<double, N, 1> d = Space::difference(points[i], mean);
    covariance += weights.other * d * d.transpose();
  }
}

}  // namespace fail_aware
