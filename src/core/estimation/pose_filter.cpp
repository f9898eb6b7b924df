#include "core/estimation/pose_filter.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/estimation/doubtful_standstill.hpp"
#include "core/estimation/increment_covariance.hpp"
#include "core/estimation/observed_directions.hpp"
#include "core/estimation/prediction_noise.hpp"
#include "core/geometry/decompositions.hpp"
#include "core/geometry/degree.hpp"
#include "core/stamp_difference.hpp"

namespace fail_aware {

namespace {

constexpr double kInitialAcross_mps = 1.0;  // standard deviations until a motion is known
constexpr double kInitialYawRate_rad_s = 0.3;
constexpr double kDoubtfulSpeed_mps = 1.0;  // standard deviations of a motion that was kept over several sweeps
constexpr double kDoubtfulRate_rad_s = 0.1;
// Times the prediction's variance; with a larger variance a measurement leaves roll and pitch open.
constexpr double kOpenVariance = 4.0;

// Whether roll and pitch are observed. A measurement that leaves them at the prediction (the corners are seen from
// above) must not turn the reference: everything that is later measured in it would tilt with it.
bool observesTilt(const FusionResult& fusion, const Matrix6d& predicted_P) {
  return fusion.R(3, 3) < kOpenVariance * predicted_P(3, 3) && fusion.R(4, 4) < kOpenVariance * predicted_P(4, 4);
}

FilterState stateFrom(const SweepPrediction& prediction) {
  FilterState state;
  state.stamp_s = prediction.stamp_s;
  state.stamp_error_s = prediction.stamp_error_s;
  state.dt_s = prediction.dt_s;
  state.set_back_s = prediction.set_back_s;
  state.odom_reset_count = prediction.odom_reset_count;
  return state;
}

/// The covariance P of the state `from` after odom is turned by R_new_old; then the same body has the state `to`.
Matrix6d turned(const Matrix6d& P, const Vector6d& from, const Vector6d& to, const Eigen::Matrix3d& R_new_old) {
  const Matrix6d pose_covariance = rotateCovariance(poseCovarianceFromState(P, from), R_new_old);
  const Matrix6d J_inverse = inverseOf(poseFromStateJacobian(to.tail<3>()));
  return symmetric(Matrix6d(J_inverse * pose_covariance * J_inverse.transpose()));
}

}  // namespace

PoseFilter::PoseFilter(const Params& params, const VehicleModel& model, const MotionHistory::Params& history,
                       const MeasurementFusion& fusion)
    : params_(params),
      model_(model),
      fusion_(fusion),
      motion_(params.dead_reckoning, history, RoadPlaneEstimator(model.vehicle())),
      consistency_(params.consistency) {
  reset(Pose::Identity());
}

void PoseFilter::reset(const Pose& T_odom_cog) {
  ukf_.reset(vectorFromPose(T_odom_cog),
             isotropicCovariance(params_.initial_sigma_m, params_.initial_sigma_deg * kDegree));
  motion_.reset({params_.initial_speed_sigma_mps, kInitialAcross_mps, kInitialAcross_mps}, kInitialYawRate_rad_s);
  started_ = false;
  consistency_.clear();
  map_update_policy_.clear();
  first_motion_.reset();
  prediction_ = SweepPrediction();
  state_.odom_reset_count = std::exchange(state_, FilterState()).odom_reset_count;
  state_.T_odom_cog = T_odom_cog;
  state_.covariance = ukf_.covariance();
}

bool PoseFilter::setPose(const Pose& T_odom_cog) {
  if (!isFinite(T_odom_cog)) return false;
  const Vector6d before = ukf_.state(), after = vectorFromPose(T_odom_cog);
  const Pose T_new_old = T_odom_cog * poseFromVector(before).inverse();
  const Matrix6d P = turned(ukf_.covariance(), before, after, T_new_old.linear());
  if (!ukf_.reset(after, P)) return false;
  motion_.setPose(before, after, T_new_old);

  const Vector6d z = state_.fusion.z;
  state_.fusion.z = vectorFromPose(T_new_old * poseFromVector(z));
  state_.fusion.R = turned(state_.fusion.R, z, state_.fusion.z, T_new_old.linear());
  state_.T_odom_cog = T_odom_cog;
  state_.covariance = ukf_.covariance();
  state_.sigma_yaw_rad = std::sqrt(state_.covariance(5, 5));
  ++state_.odom_reset_count;
  map_update_policy_.setPose();
  consistency_.clear();
  return true;
}

bool PoseFilter::predict(const SweepTime& time, SweepPrediction& prediction) {
  const double dt = secondsBetween(state_.time_s(), time.time_s());
  if (!std::isfinite(time.time_s()) || (started_ && dt <= 0.0)) return false;
  prediction_ = SweepPrediction();
  prediction_.stamp_s = time.stamp_s;
  prediction_.stamp_error_s = time.error_s;
  prediction_.period_s = time.period_s;
  prediction_.set_back_s = time.set_back_s;
  interval_sigma_s_ = time.interval_sigma_s;
  prediction_.T_odom_cog_previous = state_.T_odom_cog;
  prediction_.odom_reset_count = state_.odom_reset_count;
  if (started_) {
    prediction_.dt_s = dt;
    prediction_.motion_status = state_.motion_status;
    const PredictionNoise noise = predictionNoise(
        model_, motion_, state_,
        {dt, interval_sigma_s_, ukf_.state()[5], prediction_.motionKnown(), params_.initial_speed_sigma_mps});
    process_noise_ = noise.increment;
    const MotionDerivatives motion = dt > kLongInterval_s ? fading(motion_.motion(), dt) : motion_.motion();
    ukf_.predict([&](const Vector6d& x) { return model_.predict(x, motion, dt, motion_.roadPlane()); }, noise.filter);
  }
  prediction_.T_odom_cog = poseFromVector(ukf_.state());
  prediction_.covariance = poseCovarianceFromState(ukf_.covariance(), ukf_.state());
  prediction_.sigma_yaw_rad = std::sqrt(ukf_.covariance()(5, 5));
  prediction = prediction_;
  return true;
}

const FilterState& PoseFilter::correct(const std::vector<FusionInput>& measurements, const SweepFindings& findings) {
  FilterState next = stateFrom(prediction_);
  next.view_range_m = findings.view_range_m;
  next.started = started_ || canBegin(measurements);
  const Matrix6d predicted_P = ukf_.covariance();
  std::vector<FusionInput> inputs = measurements;
  leaveOutCornersOfConvoys(inputs);
  const Vector6d innovation = applyMeasurements(inputs, next);
  ConsistencyMonitor::Inflation inflation;
  if (started_) inflation = judgeIncrement(inputs, innovation, next);
  state_ = next;
  if (!state_.started) return state_;
  if (state_.measurement_applied || !started_) first_motion_.addMeasured();
  MapUpdatePolicy::Sweep sweep = sweepForMap(state_, observesTilt(state_.fusion, predicted_P));
  sweep.motion_lost = inflation.motion_lost;
  const MapUpdatePolicy::Decision map = map_update_policy_.add(measurements, sweep);
  state_.map_update = map.update;
  if (map.out_of_sight) consistency_.clear();
  if (inflation.motion_lost) first_motion_.forget();
  started_ = true;
  trackMotion(findings.middle_s, map.begins);
  return state_;
}

// Returns what they measure, all together, less the prediction.
Vector6d PoseFilter::applyMeasurements(std::vector<FusionInput>& inputs, FilterState& next) {
  const bool doubted = doubtPrediction(inputs);
  next.fusion = correctPrediction(inputs);
  const Vector6d predicted = ukf_.state();
  next.fusion = fusion_.fuse(predicted, ukf_.covariance(), inputs, next.fusion);
  if (next.fusion.has_measurement) {
    const Matrix6d R = fusion_.literal ? next.fusion.R : covarianceForFilter(next.fusion, inputs);
    next.measurement_applied = ukf_.correct(next.fusion.z, R);
    next.filter_nis = ukf_.nis();
  }
  next.clock_jump = doubted && next.measurement_applied;
  next.fusion.prediction_overruled = next.fusion.prediction_overruled || next.clock_jump;
  next.T_odom_cog = poseFromVector(ukf_.state());
  next.covariance = ukf_.covariance();
  next.sigma_yaw_rad = std::sqrt(next.covariance(5, 5));
  return stateDifference(next.fusion.z, predicted);
}

// The increment since the last estimate, and how far it is to be believed.
ConsistencyMonitor::Inflation PoseFilter::judgeIncrement(const std::vector<FusionInput>& inputs,
                                                         const Vector6d& innovation, FilterState& next) {
  next.T_previous_now = state_.T_odom_cog.inverse() * next.T_odom_cog;
  const double factor = motion_.deadReckoning().active() ? params_.dead_reckoning_increment_factor : 1.0;
  setIncrementCovariance({params_.increment_scale, factor, params_.increment_floor_m, params_.increment_per_metre_m,
                          params_.increment_floor_deg},
                         process_noise_, prediction_, next);
  const bool is_compared = next.measurement_applied && !next.clock_jump && prediction_.motionKnown() &&
                           next.dt_s <= kLongInterval_s && (motion_.lastMeasured() || motion_.previousMeasured());
  const ConsistencyMonitor::Inflation inflation =
      addInflation(inputs, is_compared ? innovation : Vector6d::Zero().eval(), next);
  next.clock_jump = next.clock_jump || inflation.sweeps_lost;
  motion_.setVelocityUnobservable(inflation.velocity_unobservable, next.measurement_applied);
  return inflation;
}

MapUpdatePolicy::Sweep PoseFilter::sweepForMap(const FilterState& state, bool observes_tilt) const {
  MapUpdatePolicy::Sweep sweep;
  sweep.dt_s = state.dt_s;
  sweep.motion_known = prediction_.motionKnown();
  sweep.follows = motion_.lastMeasured() && state.dt_s <= kLongInterval_s;
  sweep.observed = state.measurement_applied && observes_tilt;
  sweep.measured = state.measurement_applied;
  sweep.velocity_unobservable = motion_.velocityUnobservable();
  return sweep;
}

void PoseFilter::trackMotion(double middle_s, bool map_begins) {
  const bool measured = state_.measurement_applied || map_begins;
  const bool forget_history = map_begins || state_.clock_jump || motion_.velocityObservableAgain();
  motion_.update({prediction_, state_, ukf_.state(), middle_s, measured, forget_history});
  if (state_.dt_s > 0.0) state_.speed_error = motion_.deadReckoning().speedError();
  state_.motion_status = motionStatus();
  const double speed_mps = motion_.motion().velocity_body_mps.x();
  if (first_motion_.mustSearchAgain(state_.motion_status, speed_mps, state_.speed_error)) loseMotion();
}

void PoseFilter::loseMotion() {
  state_.map_update = MapUpdate::kRestart;
  state_.motion_status = MotionStatus::kUnknown;
  state_.fusion.confirmed = false;
  consistency_.clear();
  first_motion_.searchAgain();
}

MotionStatus PoseFilter::motionStatus() const {
  if (!first_motion_.isKnown()) return MotionStatus::kUnknown;
  const bool observed = state_.measurement_applied && prediction_.motionKnown() && !motion_.deadReckoning().active();
  return observed ? MotionStatus::kObserved : MotionStatus::kDeadReckoning;
}

FilterState PoseFilter::stateAsDriven() const {
  FilterState state = state_;
  if (!prediction_.motionKnown() && !state.measurement_applied) state.dt_s = 0.0;
  // from a prediction to a measured pose: the increment takes back the prediction's error
  const bool takes_back = state.measurement_applied && state.dt_s > 0.0 && !motion_.previousMeasured();
  if (!state.clock_jump && !takes_back) return state;
  state.dt_s = std::min(state.dt_s, kLongInterval_s);  // the vehicle turns by less than half a turn within it
  Vector6d twist_cog;
  twist_cog << motion_.motion().velocity_body_mps, 0.0, 0.0, motion_.motion().rpy_rates_rad_s.z();
  state.T_previous_now = expSe3(twist_cog * state.dt_s);
  const double distance_sigma_m = kDoubtfulSpeed_mps * state.dt_s, turn_sigma_rad = kDoubtfulRate_rad_s * state.dt_s;
  state.increment_covariance.diagonal().head<3>().array() += distance_sigma_m * distance_sigma_m;
  state.increment_covariance.diagonal().tail<3>().array() += turn_sigma_rad * turn_sigma_rad;
  return state;
}

// By the sources that measure the motion since the last estimate.
FusionResult PoseFilter::correctPrediction(const std::vector<FusionInput>& inputs) {
  const Matrix6d Q = ukf_.motionNoise();
  const FusionResult result = fusion_.fuseMotion(ukf_.state(), Q, inputs);
  if (!result.motion || !ukf_.correctMotion(result.motion->z, result.motion->R)) return result;
  process_noise_ = motionNoiseAfter(process_noise_, motionGain(Q, result.motion->R), result.motion->R);
  return result;
}

// After a clock jump the prediction used the wrong interval. P grows by the prediction's error, and measurements that
// began at the prediction and searched nowhere else are dropped.
bool PoseFilter::doubtPrediction(std::vector<FusionInput>& inputs) {
  const auto doubts = [](const FusionInput& input) {
    return input.usable() && input.measurement->clock_jump_suspected && input.kind != FusionInput::Kind::kExternal;
  };
  const auto doubting = std::find_if(inputs.begin(), inputs.end(), doubts);
  if (doubting == inputs.end()) return false;
  const Vector6d error = stateDifference(vectorFromPose(doubting->measurement->T_odom_cog), ukf_.state());
  if (error.head<3>().norm() > kFarthestOff_m) return false;
  ukf_.reset(ukf_.state(), ukf_.covariance() + error * error.transpose());
  for (FusionInput& input : inputs) {
    if (input.kind != FusionInput::Kind::kExternal && !doubts(input)) input.measurement = nullptr;
  }
  return true;
}

ConsistencyMonitor::Inflation PoseFilter::addInflation(const std::vector<FusionInput>& inputs,
                                                       const Vector6d& innovation, FilterState& state) {
  ConsistencyMonitor::Sweep sweep;
  sweep.dt_s = state.dt_s;
  sweep.undecided_m = state.fusion.undecided_m;
  sweep.disagreement_m = state.fusion.disagreement_m;
  sweep.innovation_m = motion_.deadReckoning().active() ? 0.0 : innovation.head<2>().norm();
  sweep.ahead_m = state.T_odom_cog.linear().col(0).head<2>().dot(innovation.head<2>());
  if (!motion_.deadReckoning().active()) {
    sweep.per_period_m = motion_.motion().velocity_body_mps.x() * prediction_.period_s;
  }
  sweep.time_sigma_m = interval_sigma_s_ * motion_.motion().velocity_body_mps.norm();
  sweep.turn_rad = innovation.tail<3>().norm();
  sweep.tilt_rad = innovation.segment<2>(3).norm();
  sweep.overruled = state.fusion.prediction_overruled;
  for (const FusionInput& input : inputs) {
    if (input.name != kIcpPointToPlane || !input.usable()) continue;
    sweep.inlier_ratio = input.measurement->inlier_ratio;
    sweep.inliers = input.measurement->inliers;
    sweep.rms_residual_m = input.measurement->rms_residual_m;
    break;
  }
  const auto variances = state.increment_covariance.diagonal().array();
  sweep.increment_sigma_m = std::sqrt(variances.head<2>().maxCoeff());
  sweep.increment_sigma_yaw_rad = std::sqrt(variances[5]);
  sweep.dead_reckoned = prediction_.motion_status == MotionStatus::kDeadReckoning;
  const ConsistencyMonitor::Inflation inflation = consistency_.add(sweep);
  // after a predicted pose the accumulated covariance would otherwise take back what this measurement does not know
  if (inflation.unbelievable) state.fusion.confirmed = false;
  state.doubt = sumOf(inflation.doubt, clockDoubt(prediction_, state));
  state.increment_covariance += covarianceOf(state.doubt);
  return inflation;
}

}  // namespace fail_aware
