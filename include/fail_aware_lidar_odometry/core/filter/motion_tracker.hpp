// The vehicle's motion from the estimates: derivatives (paper: "Vehicle model"), the road's plane, and what goes on where
// the motion is not observed (coasting.hpp).
//
// Poses that are predictions tell nothing new of the motion; derivatives taken from them would feed on themselves and run
// away. So without a measurement the last road plane and derivatives stay, the latter without their accelerations, and
// where the measurement does not observe the motion on the road, the velocity coasts.
// The motion's feedback: a sweep corrected for a speed that is e too high and whose stamp is middle_s from its middle
// is measured -e middle_s too far on. Speeds taken from such poses would answer an error by an error, swinging up by
// themselves. What the correction does not move is the pose in the sweep's middle: the derivatives come from those.
// Units m, s, rad; axes of the body now. Failure: none. Cost: some us a sweep.
#pragma once

#include "fail_aware_lidar_odometry/core/filter/dead_reckoning.hpp"
#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"
#include "fail_aware_lidar_odometry/core/types/filter_state.hpp"
#include "fail_aware_lidar_odometry/core/types/sweep_prediction.hpp"
#include "fail_aware_lidar_odometry/core/vehicle/motion_derivatives.hpp"
#include "fail_aware_lidar_odometry/core/vehicle/road_plane.hpp"

namespace fail_aware {

class MotionTracker {
 public:
  /// The derivatives are cut to these.
  struct Limits {
    double max_speed_mps = 80.0, max_yaw_rate_rps = 3.0;
  };
  /// A sweep that is closed.
  struct Sweep {
    const SweepPrediction& prediction;
    const FilterState& state;
    const Vector6d& x;            ///< the estimate as the filter's state: x y z roll pitch yaw
    double middle_s = 0.0;        ///< SweepCorrectorReport's
    bool measured = false;        ///< its estimate is no mere prediction
    bool forget_history = false;  ///< poses from before it tell nothing of the motion now
  };

  MotionTracker(const Limits& limits, const DeadReckoning::Params& dead_reckoning, const MotionHistory::Params& history,
                const RoadPlaneEstimator& road);

  /// The motion is unknown but for its standard deviations.
  void reset(const Eigen::Vector3d& sigmas_mps, double yaw_rate_sigma_rad_s);

  /// odom is moved under the vehicle: its state before and after.
  void setPose(const Vector6d& before, const Vector6d& after, const Pose& T_new_old);

  /// Whether the sweep's measurements tell nothing of the motion; one without (`corrected` false) leaves the last answer.
  void setVelocityUnobservable(bool velocity_unobservable, bool corrected);
  bool velocityUnobservable() const { return velocity_unobservable_; }
  /// They did in the sweep before, and do again.
  bool velocityObservableAgain() const { return velocity_was_unobservable_ && !velocity_unobservable_; }

  void update(const Sweep& sweep);

  const MotionDerivatives& motion() const { return motion_; }
  const RoadPlane& roadPlane() const { return road_.plane(); }
  const DeadReckoning& dead_reckoning() const { return dead_reckoning_; }
  /// The last estimate is no mere prediction; the one before.
  bool lastMeasured() const { return last_measured_; }
  bool previousMeasured() const { return previous_measured_; }

 private:
  void remember(const Sweep& sweep);
  MotionDerivatives historyDerivatives() const;
  void updateMotion(const Sweep& sweep);
  void coast(const MotionDerivatives& last, double dt_s, const DeadReckoning::Measured* measured);
  DeadReckoning::Measured measuredMotion(const Sweep& sweep) const;
  DeadReckoning::Measured measuredTurn(const Sweep& sweep) const;

  Limits limits_;
  DeadReckoning dead_reckoning_;
  MotionHistory history_;
  RoadPlaneEstimator road_;
  MotionDerivatives motion_;
  bool velocity_unobservable_ = false, velocity_was_unobservable_ = false;  ///< the last sweep's measurements, those before
  bool last_measured_ = false, previous_measured_ = false;
  double newest_middle_s_ = 0.0;  ///< of the history's newest pose, relative to the estimate's stamp
};

}  // namespace fail_aware
