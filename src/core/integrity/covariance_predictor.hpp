// Beyond the paper: the time at which the horizontal error since t1 passes the alert limit with a given probability,
// from the accumulated covariance and its present growth.
//
// The error (x, y) is Student's t with the covariance as its scale and `degrees_of_freedom` n: most drives err less than
// a Gaussian of the same tails would, some a lot more. With scales a >= b along its axes and c = 1 - b/a it is within r
// with
//   p = 1 - 1/(2 pi) integral over phi of (1 + r^2 / (n a (1 - c sin^2 phi)))^(-n/2),
// for a Gaussian (n infinite; here 0) of exp(-r^2 / (2 a (1 - c sin^2 phi))): from a circle's sqrt(-2 ln(1 - p)) sigma
// down to a normal's two-sided quantile for a line. `radius` is that r.
//
// Growth: at constant speed v and yaw rate, the error (x, y, yaw) in the frame at t1 with heading bias h, scale bias s
// and speed error w (estimation/odometry_covariance.hpp), u the part of w's way that stays, p the pace, th the course:
//   x' = -v sin th yaw + (p v s + u w) cos th,  y' = v cos th yaw + (p v s + u w) sin th,  yaw' = v h
// driven by white noise: Q on (x, y, yaw), about the body's axes. Measurements take a part of w back, and as much is
// made anew: w' = -f w + white noise. Integrated in steps of constant course (exact for straight driving), the crossing
// found inside its step by bisection.
//
// Two times. To the alarm: until a failure has a probability of 1 - alarm_confidence. To the failure: what has not
// failed by now (probability 1 - p) fails before it with 1 - confidence, so until p has grown to
// p + (1 - confidence)(1 - p); or the time to the alarm if that is sooner. The second says how soon, the first whether
// the pose can be used at all.
//
// Inputs: m, rad, s. Failure: input that is not finite, not a covariance or above 1e12 bounds no error: failed already,
// radius 1e6 m, the largest there is. Cost: horizon_s / step_s 6x6 products.
#pragma once

#include <Eigen/Core>
#include <array>
#include <deque>
#include <optional>

#include "core/geometry/pose.hpp"
#include "fail_aware_lidar_odometry/monitor.hpp"

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
  double yaw_rate_rps = 0.0;  ///< 0: as if driving on straight

  Eigen::Matrix3d drivers = Eigen::Matrix3d::Zero();    ///< of heading bias (rad/m), scale bias, speed error (m/s)
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();      ///< (x, y, yaw) against the drivers
  double speed_noise = 0.0;                             ///< that drives the speed error, m^2/s^3
  double speed_forgotten_per_s = 0.0;                   ///< ratio of the speed error that measurements take back
  double speed_share = 0.0;                             ///< u above, 0..1: DriftRate::speed_share
  double pace = 1.0;                                    ///< p above: DriftModel::pace(), 1 or more
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

struct CovariancePrediction {
  TimeToFailure time_to_failure;
  TimeToFailure time_to_alarm;      ///< later, or the same
  double radius_m = 0.0;            ///< the radius now with `confidence`
  double failed_probability = 0.0;  ///< that the error is past the limit now
};

/// The circle that holds a horizontal error with a given probability.
class ConfidenceRadius {
 public:
  /// probability in (0, 1); degrees_of_freedom 0: Gaussian.
  explicit ConfidenceRadius(double probability, double degrees_of_freedom = 0.0);
  double operator()(const Eigen::Matrix2d& covariance) const;

 private:
  static constexpr int kTable = 64;
  std::array<double, kTable + 1> sigmas_{};  ///< by the ratio of the smaller sigma to the larger
};

/// Probability that a horizontal error is farther than `radius`.
double exceedance(const Eigen::Matrix2d& covariance, double radius, double degrees_of_freedom = 0.0);

class CovariancePredictor {
 public:
  struct Params {
    double alert_limit_m = 0.6;
    double confidence = 0.99;         ///< that what works now does not fail before the published time
    double alarm_confidence = 0.9;    ///< of the time that the state acts on: a lower one gives fewer false alarms
    double degrees_of_freedom = 8.0;  ///< of the error's distribution; 0: Gaussian
    double horizon_s = 60.0;
    /// step of the prediction: may be coarse: the crossing is found inside a step by bisection
    double step_s = 0.25;
    double rate_scale = 1.0;  ///< factor on the growth of the covariance: 1: as measured

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("alert_limit_m", self.alert_limit_m);
      v("confidence", self.confidence);
      v("alarm_confidence", self.alarm_confidence);
      v("degrees_of_freedom", self.degrees_of_freedom);
      v("horizon_s", self.horizon_s);
    }
    void validate() const;
  };

  /// Throws ParameterError.
  explicit CovariancePredictor(const Params& params);

  CovariancePrediction predict(const CovarianceGrowth& growth) const;

 private:
  Params params_;
  ConfidenceRadius radius_;
};

}  // namespace fail_aware
