// The covariance of the accumulated odometry (not in the paper): what is published as odometry.pose.covariance. The
// filter's P settles to a steady level; this one adds up what drift_model.hpp says stays of each sweep's uncertainty,
// so that it grows with distance and a heading error turns into a position error over the distance driven after it.
//
// Beside the pose's error (6) it carries, with their correlations: heading bias per metre, scale bias (both constant),
// and the error of the speed along the vehicle's axis where the measurements do not observe the motion along it (a
// tunnel: successive errors are then alike, not independent); it is forgotten where they do.
//
// Convention: geometry/pose.hpp's (m, rad; rotation about fixed axes).
// The position's part may rightly shrink: driving back to the start undoes a heading error's effect there. What never
// shrinks is the covariance referred to a fixed point of odom - but for this:
// Gaps. A pose that is a prediction (sensor gone for a moment) is uncertain; once the sweep is registered to the map
// from before the gap, it is not any longer. So from a gap on the error since the last measured pose is kept apart, and
// a measurement that a second one confirms is a Kalman step on it. What that measurement does not observe stays, and
// all of it does if the prediction was too uncertain for a search, nothing confirms it in time, or a new
// reference was begun meanwhile.
// Height, roll and pitch have in addition what the vertical reference knows of them (vertical_drift.hpp).
// Failure: propagate() returns false and changes nothing (poses or covariance not finite). Cost: some 9x9 products.
#pragma once

#include <optional>

#include "core/estimation/drift_model.hpp"
#include "core/estimation/vertical_drift.hpp"
#include "core/geometry/pose.hpp"
#include "core/types/odometry_increment.hpp"

namespace fail_aware {

/// Covariance of the pose's error with what drives it.
struct DriftState {
  static constexpr int kHeadingBias = 6, kScaleBias = 7, kSpeed = 8, kSize = 9;  ///< rad/m, 1, m/s; 0..5: the pose
  using Matrix = Eigen::Matrix<double, kSize, kSize>;
  Matrix accumulated = Matrix::Zero();
  Matrix6d transient = Matrix6d::Zero();  ///< the pose's jitter of the moment, on top
  Matrix6d pose() const { return accumulated.topLeftCorner<6, 6>() + transient; }
};

class OdometryCovariance {
 public:
  /// Throws ParameterError. The default: errors of successive sweeps are independent.
  explicit OdometryCovariance(const DriftModel::Params& drift = DriftModel::Params::independent());

  bool propagate(const Pose& T_odom_base_previous, const Pose& T_odom_base_now, const OdometryIncrement& increment);
  /// `increment_covariance`: of T_previous_now, about the previous body's axes. Its negative eigenvalues count as zero.
  bool propagate(const Pose& T_odom_base_previous, const Pose& T_odom_base_now, const Matrix6d& increment_covariance) {
    return propagate(T_odom_base_previous, T_odom_base_now,
                     OdometryIncrement{increment_covariance, Matrix6d::Zero(), 0.0, {}, false, {}, {}, false});
  }

  /// Of T_odom_base, about odom's axes. The jitter in it is the largest so far: it does not shrink with the way.
  const Matrix6d& covariance() const { return covariance_; }
  /// Of the error of the speed, m^2/s^2; 0 where it is observed.
  double speedVariance() const { return speed_variance_; }

  /// Starts again; the mark is forgotten.
  void reset(const Matrix6d& start_covariance = Matrix6d::Zero());

  /// The vehicle was set to another pose in odom, and a new map begins there. Covariances stay.
  void enterOdom();

  /// From here on (the monitor's t1) sinceMark() is the covariance of T_mark_base, about the mark's axes.
  void mark(const Pose& T_odom_mark);
  const Matrix6d& sinceMark() const { return since_mark_covariance_; }
  /// The same with all that will make it grow.
  const DriftState& driftSinceMark() const { return since_mark_; }

 private:
  void advance(const Pose& T_start_previous, const Pose& T_previous_now, const OdometryIncrement& increment,
               DriftState& state) const;

  /// How far the vehicle came from where the map began.
  struct MapDistance {
    Eigen::Vector3d begin_odom = Eigen::Vector3d::Zero();
    double farthest_m = 0.0;
  };

  /// From the last pose before a gap.
  struct Gap {
    Pose T_odom_base;
    DriftState since_start, since_mark;  ///< there
    DriftState since;                    ///< of the motion from there
    int sweeps = 0;
  };
  static OdometryIncrement sinceGap(const Gap& gap, const Pose& T_gap_now, const OdometryIncrement& increment);

  DriftModel drift_;
  DriftState since_start_;
  DriftState since_mark_;
  VerticalDrift vertical_;  ///< since the start, in addition; nothing that is horizontal depends on it
  Matrix6d covariance_ = Matrix6d::Zero();
  Matrix6d since_mark_covariance_ = Matrix6d::Zero();
  Matrix6d transient_base_ = Matrix6d::Zero();          ///< jitter of the newest pose, about its own axes
  Matrix6d largest_transient_base_ = Matrix6d::Zero();  ///< no less than any so far
  double speed_variance_ = 0.0;                         ///< of the newest speed's error
  std::optional<Pose> T_odom_mark_;
  std::optional<Gap> gap_;
  std::optional<MapDistance> map_distance_;
  bool lost_ = false;  ///< a gap was too long or too far: what comes next measures the way from nowhere before it
};

/// The constant body twist (m/s, rad/s; in the moving body's frame, hence also in that at the newest instant) that
/// makes the increment in dt_s. Nothing if the pose is not finite or dt_s is not > 0.
std::optional<Vector6d> twistFromIncrement(const Pose& T_previous_now, double dt_s);

/// Covariance of that twist, to first order; `increment_covariance` about the previous body's axes.
std::optional<Matrix6d> twistCovariance(const Matrix6d& increment_covariance, const Pose& T_previous_now, double dt_s);

}  // namespace fail_aware
