// Beyond the paper: the time at which the horizontal error since t1 passes the alert limit, from the accumulated
// covariance and its present growth. The confidence radius of a 2D Gaussian is r = k sqrt(largest eigenvalue),
// k = sqrt(-2 ln(1 - p)): the error is inside r with probability p at least.
//
// Growth: at constant speed v and yaw rate, with S the covariance of (x, y, yaw) in the frame at t1, Q the increments'
// rate, th the course:  dS/dt = L S + S L^T + R(th) Q R(th)^T,  L = v [0 0 -sin th; 0 0 cos th; 0 0 0]
// so the heading's variance turns into lateral variance with the distance driven. Integrated in steps of constant
// course (exact for straight driving), the crossing found inside its step by bisection.
//
// Inputs: m, rad, s. Failure: input not finite or not a covariance -> unknown. Cost: horizon_s / step_s 3x3 products.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>

#include "fail_aware_lidar_odometry/core/fail_aware/time_to_failure.hpp"
#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"

namespace fail_aware {

/// The (x, y, yaw) block of a pose covariance.
Eigen::Matrix3d horizontalBlock(const Matrix6d& covariance);

/// The increments' covariance per second, averaged over the last `window_s` of accepted increments.
class IncrementRate {
 public:
  /// Throws ParameterError unless window_s > 0.
  explicit IncrementRate(double window_s);

  /// `increment_covariance`: of one sweep's motion, about the previous body's axes. False: ignored (not a covariance,
  /// or dt not > 0).
  bool update(const Matrix6d& increment_covariance, double dt_s);
  /// (x, y, yaw) about the body's axes: m^2/s, m rad/s, rad^2/s. Nothing before the first increment.
  std::optional<Eigen::Matrix3d> rate() const;
  void reset() { increments_.clear(); }

 private:
  struct Increment {
    Eigen::Matrix3d covariance;
    double dt_s;
  };
  double window_s_;
  std::deque<Increment> increments_;
};

struct CovarianceGrowth {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< (x, y, yaw) since t1, in the frame at t1
  Eigen::Matrix3d rate = Eigen::Matrix3d::Zero();        ///< per second, (x, y, yaw) about the body's axes
  double course_rad = 0.0;                               ///< direction of travel in the frame at t1
  double speed_mps = 0.0;
  double yaw_rate_rps = 0.0;                             ///< 0: as if driving on straight
};

struct CovariancePrediction {
  TimeToFailure time_to_failure;
  double radius_m = -1.0;  ///< the confidence radius now; -1: unknown
};

class CovariancePredictor {
 public:
  struct Params {
    double alert_limit_m = 0.6;
    double confidence = 0.95;
    double horizon_s = 60.0;
    double step_s = 0.25;
    double rate_scale = 1.0;  ///< on the increments' covariance: calibrates for errors that are not independent

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("alert_limit_m", self.alert_limit_m);
      v("confidence", self.confidence);
      v("horizon_s", self.horizon_s);
      v("step_s", self.step_s);
      v("rate_scale", self.rate_scale);
    }
    void validate() const;
  };

  /// Throws ParameterError.
  explicit CovariancePredictor(const Params& params);

  CovariancePrediction predict(const CovarianceGrowth& growth) const;

 private:
  Params params_;
  double k_;
};

}  // namespace fail_aware
