// Velocities and accelerations of the vehicle from its own past poses (paper, section "Kinematic and Dynamic Vehicle
// Model": x'', y'', v_x, psi', psi'' "from the odometry displacement").
//
// How: every pair of consecutive poses gives one sample of six mean rates: the body twist's translation,
// log(T_previous^-1 T) / dt, and the wrapped differences of roll, pitch, yaw over dt. A mean rate belongs to the middle
// of its interval. Accelerations: slope of the least-squares line over the newest `acceleration_window_sweeps` samples.
// Rates: mean of the newest `window_sweeps` samples, each carried from its middle to the newest stamp with that slope
// (so the half interval's lag is made good). Samples weigh dt^2 (a pose's error is the same over a short interval as
// over a long one). Three rates are not carried forward: z's is the plain mean, roll's and pitch's that of the newest
// interval. They oscillate on the suspension or carry little but noise, and a straight line through that predicts worse
// than none; so they hold half an interval (z: half a window) before the newest stamp.
// `second_differences` instead takes the article literally: first and second differences of the newest two and three
// poses, as if they held at the newest stamp.
// Failure: fewer than two poses -> `valid` false, all zero. Exactly two -> accelerations zero.
// Cost: one logarithm per push, O(window) per derivatives(); no allocation after construction.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/geometry/pose.hpp"

namespace fail_aware {

/// At the newest pose's stamp; body = axes of the centre of gravity (x forward, y left, z up).
struct MotionDerivatives {
  bool valid = false;
  /// R_odom_cog^T d(position in odom)/dt
  Eigen::Vector3d velocity_body_mps = Eigen::Vector3d::Zero();
  /// Derivative of the three components above, the article's x'', y'' beside psi' v_x. It is not what an accelerometer
  /// feels: the inertial acceleration is this + angular velocity x velocity_body_mps (plus gravity for a sensor).
  Eigen::Vector3d acceleration_body_mps2 = Eigen::Vector3d::Zero();
  /// d(roll, pitch, yaw)/dt (roll, pitch: over the newest interval) and its derivative
  Eigen::Vector3d rpy_rates_rad_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d rpy_accelerations_rad_s2 = Eigen::Vector3d::Zero();
};

class MotionHistory {
 public:
  struct Params {
    int window_sweeps = 2;               ///< intervals that give the rates
    int acceleration_window_sweeps = 4;  ///< intervals that give the accelerations
    bool second_differences = false;     ///< the article's finite differences instead
    /// a pose that comes sooner replaces its predecessor: rates over less time are noise
    double min_interval_s = 0.02;
    /// intervals whose middle is older are left out: a car's acceleration changes within a second
    double max_age_s = 1.0;
    double max_acceleration_mps2 = 12.0;  ///< longer acceleration vectors are cut to this: tyres can do no more
    double max_angular_acceleration_rad_s2 = 10.0;  ///< likewise, each of roll, pitch, yaw

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("window_sweeps", self.window_sweeps);
      v("acceleration_window_sweeps", self.acceleration_window_sweeps);
      v("second_differences", self.second_differences);
    }
    void validate() const;
  };

  explicit MotionHistory(const Params& params);

  /// False, and nothing changes: stamp not after the newest one, or a value that is not finite.
  bool push(double stamp_s, const Pose& T_odom_cog);

  MotionDerivatives derivatives() const;

  /// The same motion in another odom: every pose becomes T_new_old * pose.
  void move(const Pose& T_new_old);

  std::size_t size() const { return size_; }
  void clear() { size_ = 0; }

 private:
  struct Sample {
    double stamp_s = 0.0;
    Pose T_odom_cog = Pose::Identity();
    Eigen::Vector3d rpy_rad = Eigen::Vector3d::Zero();
    // since the previous sample; meaningless in the oldest one
    double interval_s = 0.0;
    Vector6d mean_rates = Vector6d::Zero();  // body velocity, rpy rates
  };

  const Sample& fromNewest(std::size_t age) const;
  Vector6d meanAccelerations(std::size_t samples) const;
  Vector6d ratesAtNewest(std::size_t samples, const Vector6d& accelerations) const;

  Params params_;
  std::vector<Sample> ring_;
  std::size_t next_ = 0;
  std::size_t size_ = 0;
};

}  // namespace fail_aware
