// The vehicle's velocity and yaw rate, and how uncertain they are while registration does not observe them (a tunnel,
// an open field). Not in the paper.
//
// Along an unobserved direction the poses are predictions; derivatives taken from them would feed back on themselves.
// Where little is observed, the derivatives of unsure poses wander: on highways until posts are paired with their
// neighbours. So a separate Kalman filter estimates velocity v and acceleration a (a: first-order Markov, standard
// deviation `acceleration_mps2`, correlation time `acceleration_time_s`). A sweep's fused measurement with covariance R
// corrects the velocity with covariance (R + P) / dt^2, where P is that of the last estimate, and at least R: what it
// takes back of that estimate's error is no speed. Directions that the measurement does not observe are left out. The
// sources of kind kMotion (the road's profile) do not know the error of the last estimate: they correct the velocity by
// themselves, with 2 R / dt^2, and do not end the dead reckoning. The yaw rate is treated the same way, without P; the
// yaw acceleration decreases with speed, since fast bends are wide (`turning_speed_mps`).
// A wrong velocity moves every later increment the same way, so the position's variance grows as t^2 and faster:
// speedError() gives the accumulated covariance the size of the error along the road and how much of it persists.
// Vectors: m, m/s, rad/s, in the axes of the current body (x forward, y left, z up). Cost: about 2 us.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>

#include "core/estimation/vehicle/motion_derivatives.hpp"
#include "core/geometry/pose.hpp"
#include "core/parameters/check.hpp"
#include "core/types/speed_error.hpp"

namespace fail_aware {

class DeadReckoning {
 public:
  struct Params {
    /// largest sigma of R along and across the road that observes the motion
    double observed_sigma_m = 0.05;
    double observed_sigma_deg = 0.15;  ///< the same for the heading
    /// this many consecutive observed sweeps end the dead reckoning: then the windows of the derivatives are full
    int observed_sweeps = 5;
    /// sigma of R up to which the poses alone give the velocity (0.3 m/s from two poses at 10 Hz), and from which on
    /// the filter does
    double sure_sigma_m = 0.02, unsure_sigma_m = 0.04;
    double acceleration_mps2 = 0.7;           ///< standard deviation along the road
    double lateral_acceleration_mps2 = 0.15;  ///< standard deviation of the components across the road and up
    double acceleration_time_s = 1.5;         ///< correlation time of the acceleration: one push on a pedal
    double yaw_acceleration_rad_s2 = 0.45;    ///< standard deviation up to turning_speed_mps
    /// above this speed the yaw acceleration falls with the square of the speed; 0.45 rad/s at this speed is a lateral
    /// acceleration of 3 m/s^2, about what drivers accept
    double turning_speed_mps = 6.7;
    /// correlation time of the yaw acceleration: one turn of the steering wheel
    double yaw_acceleration_time_s = 0.5;
    /// a measurement with a larger sigma does not correct the speed: the speed would have a sigma of 14 m/s at 10 Hz
    double max_measured_sigma_m = 1.0;
    double max_measured_sigma_deg = 3.0;  ///< the same for the yaw rate

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("acceleration_mps2", self.acceleration_mps2, requireNotNegative);
      v("lateral_acceleration_mps2", self.lateral_acceleration_mps2, requireNotNegative);
      v("yaw_acceleration_rad_s2", self.yaw_acceleration_rad_s2, requireNotNegative);
    }
  };

  /// Since the last estimate, with the covariance of the distance, m^2.
  struct MeanVelocity {
    Eigen::Vector3d velocity_mps;
    Eigen::Matrix3d R;
  };

  /// The motion since the last estimate as one sweep measures it.
  struct Measured {
    Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
    double yaw_rate_rad_s = 0.0;
    Eigen::Matrix3d R = Eigen::Matrix3d::Zero();  ///< of the measured position, m^2
    double yaw_variance = 0.0;                    ///< of the measured heading, rad^2
    /// Of the last estimate's position, from which the velocity is measured, m^2: after dead reckoning larger than R.
    Eigen::Matrix3d P_previous = Eigen::Matrix3d::Zero();
    std::optional<MeanVelocity> motion;  ///< what sources of kind kMotion measured
  };

  explicit DeadReckoning(const Params& params) : params_(params) {}

  /// Forgets the motion; only its standard deviations are known.
  void reset(const Eigen::Vector3d& sigmas_mps, double yaw_rate_sigma_rad_s);

  /// Whether a measurement observes the motion on the road.
  bool observes(const Measured& measured) const;

  /// A mean over dt_s becomes the motion at its end, as far as the driver's accelerations let it.
  void widenForGap(double dt_s, Measured& measured) const;

  /// How far the poses up to this measurement give the velocity better than the filter: 0 to 1; dead reckoning: 0,
  /// the first sweeps of a drive: 1.
  double sureness(const Measured& measured) const;

  /// From the first sweep that is not observed until `observed_sweeps` consecutive observed ones.
  bool active() const { return active_; }

  /// Finishes a sweep, or one without a measurement (null). `before`: at the last sweep; returns the motion now, but
  /// for rates and accelerations of roll and pitch, which stay.
  MotionDerivatives filter(const MotionDerivatives& before, double dt_s, const Measured* measured);

  /// Covariance that the uncertain motion adds to the next increment (x y z, m^2; yaw, rad^2). Zero unless active.
  Eigen::Matrix4d incrementCovariance(double dt_s) const;

  /// The covariance that the driver's accelerations add to an increment over dt_s (x y z, m^2, and yaw, rad^2; active
  /// or not). The motion comes from poses previous_dt_s apart, so it is old and stays uncorrected during the increment.
  /// Limited to the value at 3 s and to 0.25 rad.
  Eigen::Matrix4d drivenCovariance(double dt_s, double previous_dt_s, double speed_mps) const;
  /// What a longer interval adds to that.
  Eigen::Matrix4d drivenLaterCovariance(double dt_s, double speed_mps) const;

  /// Of the last finished sweep, along the vehicle. Zero unless active.
  SpeedError speedError() const { return active_ ? SpeedError{std::max(0.0, S_(0, 0)), kept_} : SpeedError(); }

 private:
  double yawAcceleration_rad_s2(double speed_mps) const;
  MotionDerivatives predict(const MotionDerivatives& before, double dt_s);
  bool isObservedWith(const Measured& measured) const;
  void correctVelocity(const Eigen::Vector3d& velocity_mps, const Eigen::Matrix3d& R, const Eigen::Matrix3d& P_previous,
                       double dt_s, MotionDerivatives& motion);
  void correctYawRate(const Measured& measured, double dt_s, MotionDerivatives& motion);

  Params params_;
  Matrix6d S_ = Matrix6d::Zero();                    ///< of (velocity, acceleration)
  Eigen::Matrix2d S_yaw_ = Eigen::Matrix2d::Zero();  ///< of (yaw rate, yaw acceleration)
  int observed_in_a_row_ = 0;
  double kept_ = 0.0;  ///< ratio of the previous sweep's speed error along the vehicle that persists
  bool active_ = false;
};

}  // namespace fail_aware
