#include "core/estimation/motion_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/estimation/largest_values.hpp"
#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"
#include "core/stamp_difference.hpp"

namespace fail_aware {

namespace {

constexpr double kDoubtfulTurn_rad = 0.5 * kDegree;
constexpr double kFastest_mps = 80.0;       // no car on a road is faster
constexpr double kFastestTurn_rad_s = 3.0;  // half a turn a second

// From the last estimate to the state z with covariance R.
DeadReckoning::MeanVelocity meanVelocity(const MotionTracker::Sweep& sweep, const Vector6d& z, const Matrix6d& R) {
  const Eigen::Matrix3d R_odom_body = sweep.state.T_odom_cog.linear();
  const Pose T_previous_measured = sweep.prediction.T_odom_cog_previous.inverse() * poseFromVector(z);
  return {logSe3(T_previous_measured).head<3>() / sweep.state.dt_s,
          R_odom_body.transpose() * poseCovarianceFromState(R, z).topLeftCorner<3, 3>() * R_odom_body};
}

// By the sources that measure the motion alone (the road's profile).
std::optional<DeadReckoning::MeanVelocity> motionAlone(const MotionTracker::Sweep& sweep) {
  const std::optional<MotionMeasurement>& motion = sweep.state.fusion.motion;
  if (!motion) return std::nullopt;
  return meanVelocity(sweep, motion->z, motion->R);
}

}  // namespace

void MotionTracker::reset(const Eigen::Vector3d& sigmas_mps, double yaw_rate_sigma_rad_s) {
  history_.clear();
  motion_ = MotionDerivatives();
  dead_reckoning_.reset(sigmas_mps, yaw_rate_sigma_rad_s);
  road_.clear();
  last_measured_ = previous_measured_ = false;
  velocity_unobservable_ = velocity_was_unobservable_ = false;
  position_covariance_.setZero();
}

void MotionTracker::setPose(const Vector6d& before, const Vector6d& after, const Pose& T_new_old) {
  history_.move(T_new_old);
  road_.turn(T_new_old.linear());
  position_covariance_ = (T_new_old.linear() * position_covariance_ * T_new_old.linear().transpose()).eval();
  const Eigen::Matrix3d rates_after_before =
      fixedAxisFromRpyRates(after.tail<3>()).inverse() * T_new_old.linear() * fixedAxisFromRpyRates(before.tail<3>());
  motion_.rpy_rates_rad_s = rates_after_before * motion_.rpy_rates_rad_s;
  motion_.rpy_accelerations_rad_s2 = rates_after_before * motion_.rpy_accelerations_rad_s2;
}

void MotionTracker::setVelocityUnobservable(bool velocity_unobservable, bool corrected) {
  velocity_was_unobservable_ = velocity_unobservable_;
  if (corrected) velocity_unobservable_ = velocity_unobservable;
}

void MotionTracker::update(const Sweep& sweep) {
  if (sweep.forget_history) history_.clear();
  previous_measured_ = last_measured_;
  last_measured_ = sweep.measured;
  if (sweep.measured) remember(sweep);
  updateMotion(sweep);
  if (sweep.measured) road_.update(sweep.state.time_s(), sweep.x, motion_);
  position_covariance_ = sweep.state.covariance.topLeftCorner<3, 3>();
}

// Stores the pose in the sweep's middle, moved there with the motion that the sweep was deskewed with.
void MotionTracker::remember(const Sweep& sweep) {
  const FilterState& state = sweep.state;
  const SweepPrediction& prediction = sweep.prediction;
  const double middle_s = sweep.middle_s;
  newest_middle_s_ = 0.0;
  Pose T_odom_cog = state.T_odom_cog;
  // the first motion was found over more than one interval and is not the motion of the last one
  const bool knows_motion = prediction.motionKnown() || previous_measured_;
  if (state.measurement_applied && knows_motion && state.dt_s > 0.0 && std::isfinite(middle_s)) {
    const Pose T_previous_now = prediction.motionKnown() ? prediction.T_previous_now()
                                                         : state.T_previous_now;  // the motion that the search found
    T_odom_cog = T_odom_cog * expSe3(logSe3(T_previous_now) * (middle_s / state.dt_s));
    newest_middle_s_ = middle_s;
  }
  history_.push(state.time_s() + newest_middle_s_, T_odom_cog);
}

// Extrapolated from the newest sweep's middle to its stamp; z, roll and pitch are not, as in the history.
MotionDerivatives MotionTracker::historyDerivatives() const {
  MotionDerivatives motion = history_.derivatives();
  motion.velocity_body_mps.head<2>() -= newest_middle_s_ * motion.acceleration_body_mps2.head<2>();
  motion.rpy_rates_rad_s.z() -= newest_middle_s_ * motion.rpy_accelerations_rad_s2.z();
  return motion;
}

DeadReckoning::Measured MotionTracker::measuredMotion(const Sweep& sweep) const {
  const FilterState& state = sweep.state;
  const DeadReckoning::MeanVelocity mean = meanVelocity(sweep, state.fusion.z, state.fusion.R);
  DeadReckoning::Measured measured;
  if (previous_measured_) {
    const Eigen::Matrix3d R_odom_body = state.T_odom_cog.linear();
    const double yaw_previous_rad = rpyFromRotation(sweep.prediction.T_odom_cog_previous.linear()).z();
    measured.velocity_mps = mean.velocity_mps;
    measured.yaw_rate_rad_s = wrapAngle(state.fusion.z[5] - yaw_previous_rad) / state.dt_s;
    measured.P_previous = R_odom_body.transpose() * position_covariance_ * R_odom_body;
  } else {  // an increment from a prediction includes the prediction's error; one from a measured pose does not
    measured.velocity_mps = historyDerivatives().velocity_body_mps;
    measured.yaw_rate_rad_s = historyDerivatives().rpy_rates_rad_s.z();
  }
  measured.R = mean.R;
  // While the speed is not known, a little of an error of the height would be taken for metres per second.
  measured.R.topRightCorner<2, 1>().setZero();
  measured.R.bottomLeftCorner<1, 2>().setZero();
  measured.yaw_variance = state.fusion.R(5, 5);
  if (previous_measured_ && state.dt_s > kLongGap_s) dead_reckoning_.widenForGap(state.dt_s, measured);
  return measured;
}

void MotionTracker::filterVelocity(const MotionDerivatives& last, double dt_s,
                                   const DeadReckoning::Measured* measured) {
  MotionDerivatives before = last;
  if (!measured) {
    before.acceleration_body_mps2.setZero();
    before.rpy_accelerations_rad_s2.setZero();
  }
  const MotionDerivatives motion = dead_reckoning_.filter(before, dt_s, measured);
  motion_.velocity_body_mps = motion.velocity_body_mps;
  motion_.acceleration_body_mps2 = motion.acceleration_body_mps2;
  motion_.rpy_rates_rad_s.z() = motion.rpy_rates_rad_s.z();
  motion_.rpy_accelerations_rad_s2.z() = motion.rpy_accelerations_rad_s2.z();
}

void MotionTracker::blendVelocity(const MotionDerivatives& of_poses, double ratio) {
  motion_.velocity_body_mps += ratio * (of_poses.velocity_body_mps - motion_.velocity_body_mps).eval();
  motion_.acceleration_body_mps2 += ratio * (of_poses.acceleration_body_mps2 - motion_.acceleration_body_mps2).eval();
  double& yaw_rate = motion_.rpy_rates_rad_s.z();
  yaw_rate += ratio * (of_poses.rpy_rates_rad_s.z() - yaw_rate);
  double& yaw_acceleration = motion_.rpy_accelerations_rad_s2.z();
  yaw_acceleration += ratio * (of_poses.rpy_accelerations_rad_s2.z() - yaw_acceleration);
}

// The heading stays weakly observed when the speed is not: everything in sight turns about the vehicle.
DeadReckoning::Measured MotionTracker::measuredTurn(const Sweep& sweep) const {
  DeadReckoning::Measured measured = measuredMotion(sweep);
  measured.R = kLargestVariance * Eigen::Matrix3d::Identity();
  measured.yaw_variance += kDoubtfulTurn_rad * kDoubtfulTurn_rad;
  return measured;
}

void MotionTracker::updateMotion(const Sweep& sweep) {
  const FilterState& state = sweep.state;
  const MotionDerivatives last = state.dt_s > kLongInterval_s ? fading(motion_, state.dt_s) : motion_;
  const bool unobservable = velocity_unobservable_ || velocity_was_unobservable_;
  if (state.measurement_applied && !state.clock_jump && !unobservable) {
    followPoses(sweep, last);
  } else {
    coast(sweep, last);
  }
  const double speed = motion_.velocity_body_mps.norm();
  if (speed > kFastest_mps) motion_.velocity_body_mps *= kFastest_mps / speed;
  double& yaw_rate = motion_.rpy_rates_rad_s.z();
  yaw_rate = std::clamp(yaw_rate, -kFastestTurn_rad_s, kFastestTurn_rad_s);
}

void MotionTracker::followPoses(const Sweep& sweep, const MotionDerivatives& last) {
  const MotionDerivatives of_poses = historyDerivatives();
  motion_ = of_poses;
  if (!(sweep.state.dt_s > 0.0)) return;
  DeadReckoning::Measured measured = measuredMotion(sweep);
  measured.motion = motionAlone(sweep);
  filterVelocity(last, sweep.state.dt_s, &measured);
  blendVelocity(of_poses, dead_reckoning_.sureness(measured));
}

void MotionTracker::coast(const Sweep& sweep, const MotionDerivatives& last) {
  const FilterState& state = sweep.state;
  motion_.rpy_accelerations_rad_s2.setZero();
  motion_.rpy_rates_rad_s.head<2>().setZero();
  motion_.acceleration_body_mps2.setZero();
  if (!(state.dt_s > 0.0)) return;
  if (!state.measurement_applied) {
    DeadReckoning::Measured measured;  // by the road's profile alone
    measured.R = kLargestVariance * Eigen::Matrix3d::Identity();
    measured.yaw_variance = kLargestVariance;
    measured.motion = motionAlone(sweep);
    filterVelocity(last, state.dt_s, measured.motion ? &measured : nullptr);
  } else if (!state.clock_jump) {
    MotionDerivatives steady = last;
    steady.acceleration_body_mps2.setZero();
    const DeadReckoning::Measured turn = measuredTurn(sweep);
    filterVelocity(steady, state.dt_s, previous_measured_ ? &turn : nullptr);
  }
}

}  // namespace fail_aware
