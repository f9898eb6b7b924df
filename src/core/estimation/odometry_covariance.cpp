#include "core/estimation/odometry_covariance.hpp"

#include <algorithm>
#include <cmath>

#include "core/estimation/observed_directions.hpp"
#include "core/geometry/decompositions.hpp"
#include "core/geometry/rotation.hpp"

namespace fail_aware {

namespace {

bool isUsable(const OdometryIncrement& increment) {
  return increment.motion.allFinite() && (!increment.registration || increment.registration->allFinite()) &&
         std::isfinite(increment.dt_s) && increment.dt_s >= 0.0 && std::isfinite(increment.doubt.sigma_m) &&
         std::isfinite(increment.doubt.sigma_yaw_rad) && std::isfinite(increment.speed_error.variance_m2_s2) &&
         std::isfinite(increment.speed_error.kept);
}

constexpr ObservedLimit kObserved_m = {0.3, 0.5}, kObserved_rad = {0.01, 0.02};
constexpr int kConfirmedAlone = 20;             // registered sweeps in a row: what only one source measures
constexpr int kMaxUnconfirmedSweeps = 100;      // then the map from before is out of sight
constexpr double kMaxUnconfirmedSigma_m = 5.0;  // beyond it the search may well settle elsewhere
// Standard deviation along the road of a registration that observes almost nothing. A simulated tunnel has 0.05 to 0.2
// m where niches are in view.
constexpr double kWeakStretch_m = 0.5;
// A sweep is corrected as if its speed and turn rate were constant. Where they change from one sweep to the next, the
// pose jitters by these ratios of the change, taken over a sweep: surrogate drives, rms.
constexpr double kBentTurn = 0.06, kBentDistance = 0.1;
constexpr double kMostTurn_rps2 = 5.0, kMost_mps2 = 20.0;  // a larger change is no motion
constexpr double kLeastReplaced = 1e-4;                    // at standstill the rate is that of a very slow drive

// The jitter of a pose whose sweep was corrected with a motion that changed meanwhile.
Matrix6d bentSweep(const DriftStep& before, const DriftStep& now) {
  Matrix6d jitter = Matrix6d::Zero();
  const double sweep_s = std::min(before.dt_s, now.dt_s);
  if (!(sweep_s > 0.0)) return jitter;
  const double rate_rps = std::abs(now.turn_rad / now.dt_s - before.turn_rad / before.dt_s);
  const double speed_mps = (now.step_m / now.dt_s - before.step_m / before.dt_s).head<2>().norm();
  if (rate_rps > kMostTurn_rps2 * sweep_s || speed_mps > kMost_mps2 * sweep_s) return jitter;
  const double sigma_m = kBentDistance * sweep_s * speed_mps, sigma_rad = kBentTurn * sweep_s * rate_rps;
  jitter(0, 0) = jitter(1, 1) = sigma_m * sigma_m;
  jitter(5, 5) = sigma_rad * sigma_rad;
  return jitter;
}

// The registration, with what it does not observe left open.
Matrix6d observed(const Matrix6d& registration) {
  Matrix6d R = positiveSemidefinite(registration);
  openUnobserved(kObserved_m, R.topLeftCorner<3, 3>());
  openUnobserved(kObserved_rad, R.bottomRightCorner<3, 3>());
  return R;
}

}  // namespace

OdometryCovariance::OdometryCovariance(const DriftModel& drift) : drift_(drift) { reset(); }

bool OdometryCovariance::propagate(const Pose& T_odom_cog_previous, const Pose& T_odom_cog_now,
                                   const OdometryIncrement& increment) {
  if (!isFinite(T_odom_cog_previous) || !isFinite(T_odom_cog_now) || !isUsable(increment)) return false;
  const Pose T_previous_now = T_odom_cog_previous.inverse() * T_odom_cog_now;
  const Eigen::Matrix3d R_odom = T_odom_cog_previous.linear();
  DriftStep step{R_odom};
  step.step_m = T_previous_now.translation();
  step.turn_rad = rpyFromRotation(T_previous_now.linear()).z();
  step.dt_s = increment.dt_s;
  step.speed_error = increment.speed_error;
  step.motion = positiveSemidefinite(increment.motion);
  DriftState since_start = since_start_;
  predictDrift(step, R_odom, since_start);

  const Confirmation confirmation =
      takeRegistration(increment, rotateCovariance(since_start.inMap(), R_odom.transpose()), step);
  const MapDistance map_distance = extendMap(increment, T_odom_cog_previous, T_odom_cog_now, step);
  correctDrift(step, R_odom, since_start);
  if (!since_start.C.allFinite() || !step.transient.allFinite()) return false;

  confirmation_ = confirmation;
  map_distance_ = map_distance;
  since_start_ = since_start;
  last_step_ = step;
  transient_cog_ = rotateCovariance(step.transient, T_previous_now.linear().transpose());
  largest_transient_cog_ += positiveSemidefinite(transient_cog_ - largest_transient_cog_);
  vertical_.advance(T_odom_cog_now.translation() - T_odom_cog_previous.translation(), increment.tilt_moment);
  covariance_ = since_start_.accumulated() +
                symmetric(rotateCovariance(largest_transient_cog_, T_odom_cog_now.linear())) + vertical_.covariance();
  return true;
}

// K, and whether the map is out of sight.
OdometryCovariance::Confirmation OdometryCovariance::takeRegistration(const OdometryIncrement& increment,
                                                                      const Matrix6d& in_map, DriftStep& step) const {
  const bool measured = increment.registration.has_value(), restarted = increment.map_update == MapUpdate::kRestart;
  const Matrix6d D = positiveSemidefinite(in_map);
  Confirmation next = confirmation_;
  next.measured = measured;
  next.alone_in_a_row = measured && increment.alone ? std::min(confirmation_.alone_in_a_row + 1, kConfirmedAlone) : 0;
  const bool confirmed = measured && (increment.confirmed || next.alone_in_a_row == kConfirmedAlone);
  if (confirmed) next.open_sweeps = kConfirmed;
  if (!measured || next.open_sweeps != kConfirmed) ++next.open_sweeps;
  if (measured && next.open_sweeps == kConfirmed) {
    const Matrix6d R = observed(*increment.registration);
    const Matrix6d K = solutionOf(D + R, D).transpose();
    step.left -= K;
    step.registration = symmetric(K * R * K.transpose());
    step.transient = drift_.transient(step.registration);
    step.bent = bentSweep(last_step_, step);
  }
  const bool too_wide = !(D.diagonal().head<2>().maxCoeff() < kMaxUnconfirmedSigma_m * kMaxUnconfirmedSigma_m);
  const bool out_of_sight = next.open_sweeps > kMaxUnconfirmedSweeps || (next.open_sweeps != kConfirmed && too_wide);
  const bool inserted = increment.map_update == MapUpdate::kInsert;
  step.replaced = out_of_sight || restarted ? 1.0
                  : inserted                ? drift_.mapReplaced(step.step_m.norm(), increment.view_range_m)
                                            : 0.0;
  if (restarted || (out_of_sight && measured)) {
    next.open_sweeps = kConfirmed;
  } else if (out_of_sight) {
    next.open_sweeps = kMaxUnconfirmedSweeps + 1;
  }
  return next;
}

// What the map gets beside the pose's error.
OdometryCovariance::MapDistance OdometryCovariance::extendMap(const OdometryIncrement& increment,
                                                              const Pose& T_odom_cog_previous,
                                                              const Pose& T_odom_cog_now, DriftStep& step) const {
  const bool is_new = !map_distance_ || increment.map_update == MapUpdate::kRestart;
  MapDistance way = is_new ? MapDistance{T_odom_cog_previous.translation(), 0.0} : *map_distance_;
  const double farthest_before_m = way.farthest_m;
  way.farthest_m = std::max(way.farthest_m, (T_odom_cog_now.translation() - way.begin_odom).norm());
  step.lasting = drift_.registration_ratio * step.replaced * step.registration + covarianceOf(increment.doubt);
  step.lasting.diagonal() += drift_.walkVariances(step.step_m.norm());
  step.to_map = step.lasting;
  step.to_map.diagonal() += drift_.newMapVariances(farthest_before_m, way.farthest_m);
  return way;
}

// Of an error e in d the registration leaves (I - K) e, of which m gets its part in each sweep until nothing is left.
DriftRate OdometryCovariance::rate() const {
  const DriftStep& step = last_step_;
  const double replaced = std::max(step.replaced, kLeastReplaced);
  const Matrix6d stays = replaced * inverseOf(Matrix6d::Identity() - (1.0 - replaced) * step.left) * step.left;
  DriftRate rate;
  rate.covariance = symmetric(Matrix6d(stays * step.motion * stays.transpose())) + step.lasting;
  rate.speed_share = std::clamp(stays(0, 0), 0.0, 1.0);
  rate.on_weak_stretch = rateOnWeakStretch();
  rate.open = confirmation_.open_sweeps != kConfirmed;
  return rate;
}

// The same in one dimension, with the steady variance of d before a registration: D = D (D + R)^-1 R + motion.
DriftRate::Along OdometryCovariance::rateOnWeakStretch() const {
  constexpr double R = kWeakStretch_m * kWeakStretch_m;
  const double replaced = std::max(last_step_.replaced, kLeastReplaced), motion = last_step_.motion(0, 0);
  const double D = 0.5 * (motion + std::sqrt(motion * motion + 4.0 * motion * R)), K = D / (D + R);
  const double stays = replaced * (1.0 - K) / (1.0 - (1.0 - replaced) * (1.0 - K));
  return {stays * stays * motion + drift_.registration_ratio * replaced * K * K * R, stays};
}

void OdometryCovariance::reset(const Matrix6d& start_covariance) {
  const Eigen::Vector2d biases = drift_.biasVariances();
  since_start_ = DriftState();
  vertical_ = VerticalDrift();
  if (start_covariance.allFinite()) since_start_.C.topLeftCorner<6, 6>() = positiveSemidefinite(start_covariance);
  since_start_.C.diagonal().segment<2>(DriftState::kHeadingBias) = biases;
  covariance_ = since_start_.pose();
  transient_cog_.setZero();
  largest_transient_cog_.setZero();
  confirmation_ = Confirmation();
  last_step_ = DriftStep();
  map_distance_.reset();
}

void OdometryCovariance::enterOdom() {
  since_start_.foldIntoMap(1.0);
  confirmation_ = Confirmation();
  map_distance_.reset();
}

DriftSinceMark OdometryCovariance::mark(const Pose& T_odom_mark) const {
  constexpr int kMap = DriftState::kMap, kInMap = DriftState::kInMap, kSpeed = DriftState::kSpeed;
  if (!isFinite(T_odom_mark)) return {};
  // The pose is right by definition, so the map is off by -d. Unless it was measured and d is open since a predicted
  // pose: what the measured pose has to do with the map from before is not known.
  const Eigen::Matrix3d R_mark_odom = T_odom_mark.linear().transpose();
  const bool open = confirmation_.open_sweeps != kConfirmed && confirmation_.measured;
  const Matrix6d D =
      open ? Matrix6d::Zero().eval() : symmetric(rotateCovariance(since_start_.inMap(), R_mark_odom)).eval();
  Vector6d d_speed = since_start_.C.block<6, 1>(kInMap, kSpeed);
  d_speed << R_mark_odom * d_speed.head<3>(), R_mark_odom * d_speed.tail<3>();
  if (open) d_speed.setZero();
  DriftState at_mark;
  DriftState::Matrix& C = at_mark.C;
  C.block<6, 6>(kInMap, kInMap) = C.block<6, 6>(kMap, kMap) = D;
  C.block<6, 6>(kMap, kInMap) = C.block<6, 6>(kInMap, kMap) = -D;
  C.block<6, 1>(kInMap, kSpeed) = d_speed;
  C.block<6, 1>(kMap, kSpeed) = -d_speed;
  C.row(kSpeed) = C.col(kSpeed).transpose();
  C(kSpeed, kSpeed) = since_start_.speedVariance();
  // The jitter of the mark itself stays: all that follows is seen from there.
  C.block<6, 6>(kMap, kMap) += transient_cog_;
  C.diagonal().segment<2>(DriftState::kHeadingBias) = drift_.biasVariances();
  return {T_odom_mark.linear(), at_mark};
}

}  // namespace fail_aware
