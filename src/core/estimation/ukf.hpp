// The unscented Kalman filter of the vehicle's pose (paper, section "Vehicle Pose Estimation System").
//
// State (x, y, z, roll, pitch, yaw) of the centre of gravity in odom, m and rad. The measurement is the state itself
// (C = I); its covariance R may change every sweep. Angles wrap in means, differences and innovations.
// After every call P is symmetric with every eigenvalue >= kMinSigma^2, for any R from singular to huge: the
// correction works in coordinates where P is the identity and R diagonal, so it never subtracts large numbers.
// This P is the filter's own (it gates measurements and settles by design), not the accumulated odometry covariance.
// Failure: a value that is not finite or an R or Q with a negative eigenvalue -> false, nothing changes.
// Cost: predict 13 model calls and four 6x6 eigendecompositions, correct three; ~10 us.
#pragma once

#include <functional>

#include "core/geometry/pose.hpp"

namespace fail_aware {

class Ukf {
 public:
  using Model = std::function<Vector6d(const Vector6d&)>;

  /// m and rad: least standard deviation of P in every direction, far below any pose error, above rounding.
  static constexpr double kMinSigma = 1e-6;

  /// Restarts from this state and forgets the last correction.
  bool reset(const Vector6d& state, const Matrix6d& covariance);

  bool predict(const Model& model, const Matrix6d& Q);
  bool correct(const Vector6d& z, const Matrix6d& R);

  /// Corrects the last predict() by a measurement of the motion: the state z, if the state before it was right. It
  /// reduces what that step's noise Q added, but not the error of the state before.
  bool correctMotion(const Vector6d& z, const Matrix6d& R);

  const Vector6d& state() const { return state_; }
  const Matrix6d& covariance() const { return covariance_; }

  /// Q of the last predict(), less what correctMotion() found of it. Zero after reset() and correct().
  const Matrix6d& motionNoise() const { return Q_; }

  /// Squared Mahalanobis length of the last correction's innovation (z minus the state before it) under P + R, with 6
  /// degrees of freedom. Zero before the first correction.
  double nis() const { return nis_; }

 private:
  Vector6d state_ = Vector6d::Zero();
  Matrix6d covariance_ = kMinSigma * kMinSigma * Matrix6d::Identity();
  Matrix6d Q_ = Matrix6d::Zero();
  double nis_ = 0.0;
};

/// The gain K = Q (Q + R)^-1 of correctMotion(), and the covariance (I - K) Q (I - K)^T + K R K^T of a motion that a gain
/// has corrected: with that of another Q, too.
Matrix6d motionGain(const Matrix6d& Q, const Matrix6d& R);
Matrix6d motionNoiseAfter(const Matrix6d& Q, const Matrix6d& K, const Matrix6d& R);

}  // namespace fail_aware
