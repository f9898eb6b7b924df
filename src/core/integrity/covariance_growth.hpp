// How the covariance of the error since t1 grows on the way ahead (not in the paper).
//
// Growth: at constant speed v and yaw rate, the error (x, y, yaw) in the frame at t1 with heading bias h, scale bias s
// and speed error w (estimation/odometry_covariance.hpp), u the part of w's way that stays, th the course:
//   x' = -v sin th yaw + (v s + u w) cos th,  y' = v cos th yaw + (v s + u w) sin th,  yaw' = v h
// driven by white noise: Q on (x, y, yaw), about the body's axes. Measurements take a part of w back, and as much is
// made anew: w' = -f w + white noise. Integrated in steps of constant course (exact for straight driving).
// Units: m, rad, s. Cost: two 6x6 products a step.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>

#include "core/geometry/pose.hpp"

namespace fail_aware {

/// Up to rounding; bounded, so that no sum of such covariances overflows.
bool isHorizontalCovariance(const Eigen::Matrix3d& C);

struct CovarianceGrowth {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< (x, y, yaw) since t1, in the frame at t1
  Eigen::Matrix3d rate = Eigen::Matrix3d::Zero();        ///< per second, (x, y, yaw) about the body's axes
  double course_rad = 0.0;                               ///< direction of travel in the frame at t1
  double speed_mps = 0.0;
  double yaw_rate_rps = 0.0;  ///< 0: as if driving on straight

  Eigen::Matrix3d drivers = Eigen::Matrix3d::Zero();    ///< of heading bias (rad/m), scale bias, speed error (m/s)
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();      ///< (x, y, yaw) against the drivers
  double speed_noise = 0.0;                             ///< that drives the speed error, m^2/s^3
  double speed_forgotten_per_s = 0.0;                   ///< ratio of the speed error that measurements take back
  double speed_share = 0.0;                             ///< u above, 0..1: DriftRate::speed_share
  Eigen::Matrix2d transient = Eigen::Matrix2d::Zero();  ///< (x, y) of the moment, on top: does not grow

  /// A stretch of the road ahead on which the error along the vehicle grows faster.
  struct WeakStretch {
    double distance_m = 0.0;  ///< where it begins
    double rate = 0.0;        ///< m^2/s along the vehicle
    double speed_share = 0.0;
    double speed_variance = 0.0;  ///< m^2/s^2
    double speed_forgotten_per_s = 0.0;
  };
  std::optional<WeakStretch> weak_stretch;  ///< from its beginning on; none: as now, as far as the horizon
};

/// Whether all numbers are in their ranges.
bool isUsable(const CovarianceGrowth& growth);

/// The growth along the path, step by step. The state: (x, y, yaw) and the drivers.
class GrowingCovariance {
 public:
  using Matrix = Eigen::Matrix<double, 6, 6>;

  explicit GrowingCovariance(const CovarianceGrowth& growth);

  /// Prepares a step from t_s on; returns its length: at most step_s, and not beyond the beginning of the weak stretch.
  double begin(double t_s, double step_s);
  /// `dt_s` after the beginning of the step.
  Matrix after(double dt_s) const;
  /// Ends the step, with what after() gave there.
  void advance(const Matrix& at_end) { S_ = at_end; }
  const Matrix& now() const { return S_; }

 private:
  /// What of w is left after a time, its way, and the covariance of (w, way) that the noise makes.
  struct SpeedStep {
    double kept = 1.0, way_s = 0.0, variance = 0.0, cross = 0.0, way_variance = 0.0;
  };
  SpeedStep speedStep(double dt_s) const;
  void enterWeakStretch();

  CovarianceGrowth growth_;  ///< on the present stretch
  Matrix S_;
  double weak_from_s_ = std::numeric_limits<double>::infinity();
  Matrix L_ = Matrix::Zero(), Q_ = Matrix::Zero();
  Eigen::Vector2d along_ = Eigen::Vector2d::Zero();
};

}  // namespace fail_aware
