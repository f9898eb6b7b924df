// The drift since a place that counts as right from then on: the monitor's t1. OdometryCovariance::mark() makes one.
// Frame: the mark's axes; m, rad. Failure: none. Cost: two 15x15 products a sweep.
#pragma once

#include "core/estimation/drift_state.hpp"

namespace fail_aware {

class DriftSinceMark {
 public:
  DriftSinceMark() = default;
  /// `at_mark`: what is not right there, and will make the error grow.
  DriftSinceMark(const Eigen::Matrix3d& R_odom_mark, const DriftState& at_mark)
      : R_odom_mark_(R_odom_mark), state_(at_mark) {}

  /// The sweep that follows: OdometryCovariance::lastStep().
  void add(const DriftStep& step) {
    const Eigen::Matrix3d R_mark_previous = R_odom_mark_.transpose() * step.R_odom_previous;
    predictDrift(step, R_mark_previous, state_);
    correctDrift(step, R_mark_previous, state_);
    covariance_ = state_.pose();
  }

  /// Of T_mark_cog; zero at the mark.
  const Matrix6d& covariance() const { return covariance_; }
  /// The same with all that will make it grow.
  const DriftState& state() const { return state_; }

 private:
  Eigen::Matrix3d R_odom_mark_ = Eigen::Matrix3d::Identity();
  DriftState state_;
  Matrix6d covariance_ = Matrix6d::Zero();
};

}  // namespace fail_aware
