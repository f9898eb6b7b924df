// The vehicle's motion from the estimates: derivatives (paper: "Vehicle model"), the road plane, and dead reckoning
// while the motion is not observed (dead_reckoning.hpp).
//
// A pose that is only a prediction adds no information about the motion; derivatives taken from such poses would feed
// back on themselves and diverge. So without a measurement the last road plane and derivatives stay, the derivatives
// without their accelerations. Where a measurement does not observe the motion on the road, dead reckoning gives the
// velocity.
// Feedback through the deskew: if a sweep is deskewed with a speed that is too high by e, and its stamp is middle_s
// before the sweep's middle, the measured pose is off by -e middle_s. Speeds taken from such poses would answer an
// error with an error and oscillate with growing amplitude. The deskew does not move the pose in the sweep's middle, so
// the derivatives are taken from the poses in the middle.
// Units m, s, rad; axes of the current body. Failure: none. Cost: a few us a sweep.
#pragma once

#include "core/estimation/dead_reckoning.hpp"
#include "core/estimation/vehicle/motion_derivatives.hpp"
#include "core/estimation/vehicle/road_plane.hpp"
#include "core/geometry/pose.hpp"
#include "core/types/filter_state.hpp"
#include "core/types/sweep_prediction.hpp"

namespace fail_aware {

class MotionTracker {
 public:
  /// A finished sweep.
  struct Sweep {
    const SweepPrediction& prediction;
    const FilterState& state;
    const Vector6d& x;            ///< the estimate as the filter's state: x y z roll pitch yaw
    double middle_s = 0.0;        ///< from SweepCorrectorReport
    bool measured = false;        ///< the estimate is more than a prediction
    bool forget_history = false;  ///< earlier poses say nothing about the current motion
  };

  MotionTracker(const DeadReckoning::Params& dead_reckoning, const MotionHistory::Params& history,
                const RoadPlaneEstimator& road)
      : dead_reckoning_(dead_reckoning), history_(history), road_(road) {}

  /// Forgets the motion; only its standard deviations are known.
  void reset(const Eigen::Vector3d& sigmas_mps, double yaw_rate_sigma_rad_s);

  /// odom is moved under the vehicle. `before`, `after`: the vehicle's state.
  void setPose(const Vector6d& before, const Vector6d& after, const Pose& T_new_old);

  /// Whether the sweep's measurements leave the velocity unobservable. A sweep without measurements (`corrected` false)
  /// keeps the last value.
  void setVelocityUnobservable(bool velocity_unobservable, bool corrected);
  bool velocityUnobservable() const { return velocity_unobservable_; }
  /// The velocity was unobservable in the previous sweep and is observable now.
  bool velocityObservableAgain() const { return velocity_was_unobservable_ && !velocity_unobservable_; }

  void update(const Sweep& sweep);

  const MotionDerivatives& motion() const { return motion_; }
  const RoadPlane& roadPlane() const { return road_.plane(); }
  const DeadReckoning& deadReckoning() const { return dead_reckoning_; }
  /// Whether the last estimate, and the one before it, were more than predictions.
  bool lastMeasured() const { return last_measured_; }
  bool previousMeasured() const { return previous_measured_; }

 private:
  void remember(const Sweep& sweep);
  MotionDerivatives historyDerivatives() const;
  void updateMotion(const Sweep& sweep);
  void followPoses(const Sweep& sweep, const MotionDerivatives& last);
  void coast(const Sweep& sweep, const MotionDerivatives& last);
  void filterVelocity(const MotionDerivatives& last, double dt_s, const DeadReckoning::Measured* measured);
  /// Takes `ratio` of the velocity that the poses give in place of the filter's.
  void blendVelocity(const MotionDerivatives& of_poses, double ratio);
  DeadReckoning::Measured measuredMotion(const Sweep& sweep) const;
  DeadReckoning::Measured measuredTurn(const Sweep& sweep) const;

  DeadReckoning dead_reckoning_;
  MotionHistory history_;
  RoadPlaneEstimator road_;
  MotionDerivatives motion_;
  bool velocity_unobservable_ = false, velocity_was_unobservable_ = false;  ///< in the last sweep, in the one before
  bool last_measured_ = false, previous_measured_ = false;
  Eigen::Matrix3d position_covariance_ = Eigen::Matrix3d::Zero();  ///< of the last estimate, along odom's axes
  double newest_middle_s_ = 0.0;  ///< of the history's newest pose, relative to the estimate's stamp
};

}  // namespace fail_aware
