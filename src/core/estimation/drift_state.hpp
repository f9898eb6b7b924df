// The covariance of the odometry's error with what drives it, and one sweep's change of it (odometry_covariance.hpp).
#pragma once

#include "core/geometry/pose.hpp"
#include "core/types/speed_error.hpp"

namespace fail_aware {

/// m: the error of the map around the vehicle; d: that of the pose in this map; the pose's error is m + d.
struct DriftState {
  static constexpr int kMap = 0, kHeadingBias = 6, kScaleBias = 7, kSpeed = 8, kInMap = 9, kSize = 15;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;
  Matrix C = Matrix::Zero();              ///< of (m, rad/m, 1, m/s, d)
  Matrix6d transient = Matrix6d::Zero();  ///< the pose's jitter of the moment, on top

  /// Of the pose without its jitter.
  Matrix6d accumulated() const;
  Matrix6d pose() const { return accumulated() + transient; }
  Eigen::Matrix3d drivers() const { return C.block<3, 3>(kHeadingBias, kHeadingBias); }
  /// The pose against the drivers.
  Eigen::Matrix<double, 6, 3> cross() const;
  Matrix6d inMap() const { return C.block<6, 6>(kInMap, kInMap); }
  double speedVariance() const { return C(kSpeed, kSpeed); }

  /// m gets this part of d, and d keeps the rest.
  void foldIntoMap(double ratio);
};

/// One sweep; covariances, the step and I - K about the previous body's axes.
struct DriftStep {
  Eigen::Matrix3d R_odom_previous = Eigen::Matrix3d::Identity();  ///< the previous body's axes
  Eigen::Vector3d step_m = Eigen::Vector3d::Zero();
  double turn_rad = 0.0;  ///< about the vertical axis
  double dt_s = 0.0;
  SpeedError speed_error{};
  Matrix6d motion = Matrix6d::Zero();        ///< what d gets
  Matrix6d left = Matrix6d::Identity();      ///< I - K: what the registration leaves of d
  Matrix6d registration = Matrix6d::Zero();  ///< K R K^T
  Matrix6d lasting = Matrix6d::Zero();       ///< what each sweep like it adds to m beside d
  Matrix6d to_map = Matrix6d::Zero();        ///< what m gets beside d
  double replaced = 0.0;                     ///< ratio of the map that the sweep replaces
  Matrix6d transient = Matrix6d::Zero();     ///< the pose's jitter about the map
  Matrix6d bent = Matrix6d::Zero();          ///< likewise, of this sweep alone: by a change of the motion
};

/// The sweep's motion. R_start_previous: the previous body's axes in the state's.
void predictDrift(const DriftStep& step, const Eigen::Matrix3d& R_start_previous, DriftState& state);
/// Its registration, and what it does to the map.
void correctDrift(const DriftStep& step, const Eigen::Matrix3d& R_start_previous, DriftState& state);

/// The drift since a place that counts as right from then on: the monitor's t1. OdometryCovariance::mark() makes one.
class DriftSinceMark {
 public:
  DriftSinceMark() = default;
  /// `at_mark`: what is not right there, and will make the error grow.
  DriftSinceMark(const Eigen::Matrix3d& R_odom_mark, const DriftState& at_mark)
      : R_odom_mark_(R_odom_mark), state_(at_mark) {}

  /// The sweep that follows: OdometryCovariance::lastStep(). False: the sum is not finite, and nothing changes.
  bool add(const DriftStep& step) {
    const Eigen::Matrix3d R_mark_previous = R_odom_mark_.transpose() * step.R_odom_previous;
    DriftState next = state_;
    predictDrift(step, R_mark_previous, next);
    correctDrift(step, R_mark_previous, next);
    if (!next.C.allFinite()) return false;
    state_ = next;
    covariance_ = state_.pose();
    return true;
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
