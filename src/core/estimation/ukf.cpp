#include "core/estimation/ukf.hpp"

#include <algorithm>
#include <cmath>

#include "core/estimation/unscented_transform.hpp"
#include "core/geometry/decompositions.hpp"

namespace fail_aware {

namespace {

// Finite and positive semi-definite up to rounding.
bool isCovariance(const Matrix6d& C) {
  if (!C.allFinite()) return false;
  const Vector6d eigenvalues = symmetricEigenvalues(symmetric(C));
  const double largest = std::max(eigenvalues.maxCoeff(), 0.0);
  return eigenvalues.minCoeff() >= -1e-9 * largest;
}

// Symmetric, with eigenvalues raised to the floor (also relative to the largest one, so that a Cholesky root exists).
Matrix6d floored(const Matrix6d& C, double min_variance) {
  const Matrix6d S = symmetric(C);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen = symmetricEigen(S);
  const double floor = std::max(min_variance, 1e-13 * eigen.eigenvalues().maxCoeff());
  if (eigen.eigenvalues().minCoeff() >= floor) return S;
  return symmetric(Matrix6d(eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(floor).asDiagonal() *
                            eigen.eigenvectors().transpose()));
}

}  // namespace

Matrix6d motionGain(const Matrix6d& Q, const Matrix6d& R) { return solutionOf(Q + R, Q).transpose(); }

Matrix6d motionNoiseAfter(const Matrix6d& Q, const Matrix6d& K, const Matrix6d& R) {
  const Matrix6d left = Matrix6d::Identity() - K;
  return symmetric(Matrix6d(left * Q * left.transpose() + K * R * K.transpose()));
}

bool Ukf::reset(const Vector6d& state, const Matrix6d& covariance) {
  if (!state.allFinite() || !isCovariance(covariance)) return false;
  state_ = stateSum(state, Vector6d::Zero());
  covariance_ = floored(covariance, kMinSigma * kMinSigma);
  Q_.setZero();
  nis_ = 0.0;
  return true;
}

bool Ukf::predict(const Model& model, const Matrix6d& Q) {
  Q_.setZero();
  if (!isCovariance(Q)) return false;
  SigmaPoints points = sigmaPoints(state_, covariance_);
  for (Vector6d& point : points) {
    point = model(point);
    if (!point.allFinite()) return false;
  }
  Vector6d mean;
  Matrix6d covariance;
  unscentedMoments(points, mean, covariance);
  // strongly curved models can make the weighted sum indefinite; it is repaired before Q is added
  covariance = floored(covariance, 0.0) + symmetric(Q);
  if (!mean.allFinite() || !covariance.allFinite()) return false;
  state_ = mean;
  covariance_ = floored(covariance, kMinSigma * kMinSigma);
  Q_ = symmetric(Q);
  return true;
}

bool Ukf::correctMotion(const Vector6d& z, const Matrix6d& R) {
  if (!z.allFinite() || !isCovariance(R)) return false;
  const Matrix6d K = motionGain(Q_, R);
  const Vector6d state = stateSum(state_, K * stateDifference(z, state_));
  const Matrix6d Q = motionNoiseAfter(Q_, K, R);
  if (!state.allFinite() || !Q.allFinite()) return false;
  state_ = state;
  covariance_ = floored(covariance_ - (Q_ - Q), kMinSigma * kMinSigma);
  Q_ = Q;
  return true;
}

bool Ukf::correct(const Vector6d& z, const Matrix6d& R) {
  if (!z.allFinite() || !isCovariance(R)) return false;

  // P = L L^T, L^-1 R L^-T = U diag(d) U^T, so that with A = L U: P = A A^T, R = A diag(d) A^T and
  // S^-1 = A^-T diag(1 / (1 + d)) A^-1, K = A diag(1 / (1 + d)) A^-1, P after = A diag(d / (1 + d)) A^T.
  const Eigen::LLT<Matrix6d> root(covariance_);
  if (root.info() != Eigen::Success) return false;
  const Matrix6d half_whitened = root.matrixL().solve(symmetric(R));
  const Matrix6d half_whitened_transposed = half_whitened.transpose();
  const Matrix6d whitened_R = root.matrixL().solve(half_whitened_transposed);
  if (!whitened_R.allFinite()) return false;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen = symmetricEigen(symmetric(whitened_R));
  const Vector6d d = eigen.eigenvalues().cwiseMax(0.0);
  const Matrix6d A = root.matrixL() * eigen.eigenvectors();

  const Vector6d innovation = stateDifference(z, state_);
  const Vector6d whitened_innovation = root.matrixL().solve(innovation);
  const Vector6d a = eigen.eigenvectors().transpose() * whitened_innovation;
  const Vector6d gain = (1.0 + d.array()).inverse();
  const Vector6d state = stateSum(state_, A * gain.cwiseProduct(a));
  const Matrix6d covariance = A * d.cwiseProduct(gain).asDiagonal() * A.transpose();
  const double nis = gain.dot(a.cwiseAbs2());
  if (!state.allFinite() || !covariance.allFinite() || !std::isfinite(nis)) return false;

  Q_.setZero();
  nis_ = nis;
  state_ = state;
  covariance_ = floored(covariance, kMinSigma * kMinSigma);
  return true;
}

}  // namespace fail_aware
