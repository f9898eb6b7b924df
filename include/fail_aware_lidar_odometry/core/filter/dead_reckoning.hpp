// The vehicle's motion where registration does not observe it (a tunnel, an open field). Not in the article.
//
// Poses along an unobserved direction are predictions; derivatives taken from them would feed on themselves. So there
// velocity v and acceleration a have a Kalman filter of their own (a: first-order Markov, standard deviation
// `acceleration_mps2`, correlation time `acceleration_time_s`). What a sweep's fused measurement says of the velocity
// counts by its covariance R, as one of covariance 2 R / dt^2; directions in which it says nothing are left out. The
// yaw rate is treated alike; bends are the wider the faster they are driven (`turning_speed_mps`).
// A wrong velocity moves every later increment the same way, so the position's variance grows as t^2 and faster:
// speedError() tells the accumulated covariance how large the error along the road is and how much of it stays.
// Vectors: m, m/s, rad/s, axes of the body now (x forward, y left, z up). Cost: about 2 us.
#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"
#include "fail_aware_lidar_odometry/core/types/speed_error.hpp"

namespace fail_aware {

class DeadReckoning {
 public:
  struct Params {
    /// R along and across the road up to this: poses give the velocity; 0.7 m/s from two poses at 10 Hz
    double observed_sigma_m = 0.05;
    double observed_sigma_deg = 0.15;  ///< likewise of the heading
    /// so many observed sweeps in a row end the dead reckoning: the windows of the derivatives are full then
    int observed_sweeps = 5;
    double acceleration_mps2 = 0.7;           ///< standard deviation along the road;
    double lateral_acceleration_mps2 = 0.15;  ///< of the velocity's components across and up
    double acceleration_time_s = 1.5;         ///< duration of such an acceleration: a push on a pedal
    double yaw_acceleration_rad_s2 = 0.45;    ///< of the heading, up to this speed; above it
    /// faster: the yaw acceleration falls with the square of the speed; 0.45 rad/s at this speed is 3 m/s^2 across,
    /// about what drivers accept
    double turning_speed_mps = 6.7;
    /// duration of such a yaw acceleration: a turn of the steering wheel
    double yaw_acceleration_time_s = 0.5;
    /// a measurement with a larger sigma does not give the speed: the speed would have a sigma of 14 m/s at 10 Hz
    double max_measured_sigma_m = 1.0;
    double max_measured_sigma_deg = 3.0;  ///< nor the yaw rate

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("acceleration_mps2", self.acceleration_mps2);
      v("lateral_acceleration_mps2", self.lateral_acceleration_mps2);
      v("yaw_acceleration_rad_s2", self.yaw_acceleration_rad_s2);
    }
    void validate() const;
  };

  struct Motion {
    Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
    Eigen::Vector3d acceleration_mps2 = Eigen::Vector3d::Zero();
    double yaw_rate_rad_s = 0.0;
    double yaw_acceleration_rad_s2 = 0.0;
  };

  /// What a sweep's measurement says of the motion since the last estimate.
  struct Measured {
    Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
    double yaw_rate_rad_s = 0.0;
    Eigen::Matrix3d R = Eigen::Matrix3d::Zero();  ///< of its position, m^2
    double yaw_variance = 0.0;                    ///< of its heading, rad^2
  };

  explicit DeadReckoning(const Params& params);

  /// The motion is unknown but for its standard deviations.
  void reset(const Eigen::Vector3d& sigmas_mps, double yaw_rate_sigma_rad_s);

  /// Whether a measurement observes the motion on the road.
  bool observes(const Measured& measured) const;

  /// Whether this measurement leaves (or ends) the coasting. One sure pose between unsure ones does not: what the poses
  /// before it would say of velocity and acceleration is noise.
  bool settles(const Measured& measured) const;

  /// From the first sweep that is not observed until `observed_sweeps` that are.
  bool active() const { return active_; }

  /// Closes a sweep that settles the motion.
  void observed(const Measured& measured, double dt_s);

  /// Closes a sweep that does not, or (null) without a measurement. `before` is the motion at the last sweep; returns
  /// that to go on with.
  Motion coast(const Motion& before, double dt_s, const Measured* measured);

  /// What the uncertain motion adds to the next increment (x y z, m^2, and yaw, rad^2). Zero unless active.
  Eigen::Matrix4d incrementCovariance(double dt_s) const;

  /// What the driver's accelerations add to an increment over dt_s (as above; active or not), where the motion is known
  /// from poses previous_dt_s apart: it is that of some time ago, and stays so for as long as the increment lasts. As
  /// over 3 s at most, and 0.25 rad.
  Eigen::Matrix4d drivenCovariance(double dt_s, double previous_dt_s, double speed_mps) const;

  /// Of the sweep closed last, along the vehicle. Zero unless active.
  SpeedError speedError() const { return active_ ? SpeedError{std::max(0.0, S_(0, 0)), kept_} : SpeedError(); }

  Eigen::Matrix3d velocityCovariance() const { return S_.topLeftCorner<3, 3>(); }

 private:
  double yawAcceleration_rad_s2(double speed_mps) const;
  Motion begin(const Motion& before, double dt_s);
  void correctVelocity(const Measured& measured, double dt_s, Motion& motion);
  void correctYawRate(const Measured& measured, double dt_s, Motion& motion);

  Params params_;
  Matrix6d S_ = Matrix6d::Zero();                    ///< of (velocity, acceleration)
  Eigen::Matrix2d S_yaw_ = Eigen::Matrix2d::Zero();  ///< of (yaw rate, yaw acceleration)
  int observed_in_a_row_ = 0;
  double kept_ = 0.0;  ///< of the last sweep's error along the vehicle
  bool active_ = false;
};

}  // namespace fail_aware
