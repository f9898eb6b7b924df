// Velocities and accelerations of the vehicle from its own past poses (paper, section "Kinematic and Dynamic Vehicle
// Model": x'', y'', v_x, psi', psi'' "from the odometry displacement").
//
// Every pair of consecutive poses gives one sample of six mean rates: the body twist's translation,
// log(T_previous^-1 T) / dt, and the wrapped differences of roll, pitch, yaw over dt. A mean rate is valid in the
// middle of its interval. Accelerations: slope of the least-squares line over the newest `acceleration_window_sweeps`
// samples. Rates: mean of the newest `window_sweeps` samples, each extrapolated from its middle to the newest stamp
// with that slope (this removes the lag of half an interval). Samples have the weight dt^2, because a pose's error does
// not depend on the interval. Three rates are not extrapolated: z's is the plain mean, roll's and pitch's are those of
// the newest interval. They oscillate on the suspension or are mostly noise, and a straight line through them predicts
// worse than none; so they are valid half an interval (z: half a window) before the newest stamp.
// `second_differences` follows the paper literally: first and second differences of the newest two and three poses, as
// if they were valid at the newest stamp.
// Failure: fewer than two poses -> `valid` false, all zero. Exactly two -> accelerations zero.
// Cost: one logarithm per push, O(window) per derivatives().
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>

#include "core/geometry/pose.hpp"
#include "core/parameters/check.hpp"

namespace fail_aware {

/// At the newest pose's stamp; body = axes of the centre of gravity (x forward, y left, z up).
struct MotionDerivatives {
  bool valid = false;
  /// R_odom_cog^T d(position in odom)/dt
  Eigen::Vector3d velocity_body_mps = Eigen::Vector3d::Zero();
  /// Derivative of the three components above, the paper's x'', y'' beside psi' v_x. An accelerometer does not measure
  /// it: the inertial acceleration is this + angular velocity x velocity_body_mps (plus gravity for a sensor).
  Eigen::Vector3d acceleration_body_mps2 = Eigen::Vector3d::Zero();
  /// d(roll, pitch, yaw)/dt (roll, pitch: over the newest interval) and its derivative
  Eigen::Vector3d rpy_rates_rad_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d rpy_accelerations_rad_s2 = Eigen::Vector3d::Zero();
};

/// Over a long interval accelerations and the rates of roll and pitch do not last. The constant ones with the same mean
/// effect over dt_s.
MotionDerivatives fading(const MotionDerivatives& motion, double dt_s);

class MotionHistory {
 public:
  struct Params {
    int window_sweeps = 2;               ///< number of intervals for the rates
    int acceleration_window_sweeps = 4;  ///< number of intervals for the accelerations
    bool second_differences = false;     ///< use the paper's finite differences
    /// a pose that comes sooner replaces the previous one: rates over a shorter time are noise
    double min_interval_s = 0.02;
    /// intervals with an older middle are left out: a car's acceleration changes within a second
    double max_age_s = 1.0;
    double max_acceleration_mps2 = 12.0;  ///< longer acceleration vectors are shortened to this: the limit of tyres
    double max_angular_acceleration_rad_s2 = 10.0;  ///< the same for each of roll, pitch, yaw

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("window_sweeps", self.window_sweeps, within(1, 100));
      v("acceleration_window_sweeps", self.acceleration_window_sweeps, within(2, 100));
      v("second_differences", self.second_differences);
    }
  };

  explicit MotionHistory(const Params& params) : params_(params) {}

  /// Changes nothing if the stamp is not after the newest one or a value is not finite.
  void push(double stamp_s, const Pose& T_odom_cog);

  MotionDerivatives derivatives() const;

  /// Moves the history to another odom: every pose becomes T_new_old * pose.
  void move(const Pose& T_new_old);

  void clear() { samples_.clear(); }

 private:
  struct Sample {
    double stamp_s = 0.0;
    Pose T_odom_cog = Pose::Identity();
    Eigen::Vector3d rpy_rad = Eigen::Vector3d::Zero();
    // since the previous sample; undefined in the oldest one
    double interval_s = 0.0;
    Vector6d mean_rates = Vector6d::Zero();  // body velocity, rpy rates
  };

  Vector6d meanAccelerations(std::size_t samples) const;
  Vector6d ratesAtNewest(std::size_t samples, const Vector6d& accelerations) const;

  Params params_;
  std::deque<Sample> samples_;  ///< the newest first
};

}  // namespace fail_aware
