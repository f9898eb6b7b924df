// The covariance of the accumulated odometry (not in the paper): what is published as odometry.pose.covariance. The
// filter's P settles to a steady level; this one adds up the uncertainty of the increments, so that it grows with
// distance and a heading error turns into a position error over the distance driven after it.
//
// Convention: geometry/pose.hpp's (m, rad; rotation about fixed axes). Increments are taken as independent.
// The position's part may rightly shrink: driving back to the start undoes a heading error's effect there. What never
// shrinks is the covariance referred to a fixed point of odom.
// Failure: propagate() returns false and changes nothing (poses or covariance not finite). Cost: some 6x6 products.
#pragma once

#include <optional>

#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"

namespace fail_aware {

class OdometryCovariance {
 public:
  /// `increment_covariance`: of T_previous_now, about the previous body's axes. Its negative eigenvalues count as zero.
  bool propagate(const Pose& T_odom_base_previous, const Pose& T_odom_base_now, const Matrix6d& increment_covariance);

  /// Of T_odom_base, about odom's axes.
  const Matrix6d& covariance() const { return covariance_; }

  /// Starts again; the mark is forgotten.
  void reset(const Matrix6d& start_covariance = Matrix6d::Zero());

  /// From here on (the monitor's t1) sinceMark() is the covariance of T_mark_base, about the mark's axes.
  void mark(const Pose& T_odom_mark);
  bool hasMark() const { return T_odom_mark_.has_value(); }
  const Matrix6d& sinceMark() const { return since_mark_; }

 private:
  Matrix6d covariance_ = Matrix6d::Zero();
  std::optional<Pose> T_odom_mark_;
  Matrix6d since_mark_ = Matrix6d::Zero();
};

/// The constant body twist (m/s, rad/s; in the moving body's frame, hence also in that at the newest instant) that
/// makes the increment in dt_s. Nothing if the pose is not finite or dt_s is not > 0.
std::optional<Vector6d> twistFromIncrement(const Pose& T_previous_now, double dt_s);

/// Covariance of that twist, to first order; `increment_covariance` about the previous body's axes.
std::optional<Matrix6d> twistCovariance(const Matrix6d& increment_covariance, const Pose& T_previous_now,
                                        double dt_s);

}  // namespace fail_aware
