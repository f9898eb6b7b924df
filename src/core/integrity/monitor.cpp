#include "core/integrity/monitor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/estimation/increment_covariance.hpp"
#include "core/geometry/rotation.hpp"

namespace fail_aware {

namespace {

// Up to the rounding of messages and log files; a lost state of a moving vehicle is farther away.
bool isSamePlace(const Pose& a, const Pose& b) {
  constexpr double kSame_m = 1e-3, kSame_rad = 1e-5;
  return (a.translation() - b.translation()).norm() < kSame_m &&
         Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() < kSame_rad;
}

}  // namespace

void MonitorParameters::checkRules() const {
  requireParameter(predictor.horizon_s == indicator.horizon_s, "predictor.horizon_s", predictor.horizon_s,
                   "the same as indicator.horizon_s", indicator.horizon_s);
  requireParameter(thresholds.degraded_s < predictor.horizon_s, "thresholds.degraded_s", thresholds.degraded_s,
                   "< predictor.horizon_s", predictor.horizon_s);
}

FailAwareMonitor::FailAwareMonitor(const MonitorParameters& params)
    : params_(params),
      indicator_(params.indicator),
      predictor_(params.predictor),
      growth_rate_(params.rate_window_s),
      covariance_(params.drift),
      hysteresis_(params.sweeps_to_recover) {}

void FailAwareMonitor::start() {
  stop();
  requested_ = last_ && last_->motion_known ? Start::kWithNextSweep : Start::kOnceObserved;
}

void FailAwareMonitor::stop() {
  indicator_.stop();
  hysteresis_.reset();
  shortest_time_.reset();
  requested_ = Start::kNot;
  mark_ = Mark();
}

void FailAwareMonitor::reset() {
  const bool serving = started();
  stop();
  growth_rate_.reset();
  covariance_.reset();
  motion_ = Motion();
  intervals_s_.clear();
  error_unbounded_ = false;
  last_.reset();
  if (serving) requested_ = Start::kOnceObserved;
}

void FailAwareMonitor::setLimits(const MonitorParameters& params) {
  predictor_ = CovariancePredictor(params.predictor);
  params_.predictor = params.predictor;
  params_.thresholds = params.thresholds;
  params_.disagreement_m = params.disagreement_m;
  params_.min_information_ratio = params.min_information_ratio;
}

// The usual period is the median of the last intervals.
bool FailAwareMonitor::isAfterGap(double dt_s) {
  constexpr std::size_t kFewest = 3;
  if (!(dt_s > 0.0)) return false;
  const bool known = intervals_s_.size() >= kFewest;
  const double usual_s = intervals_s_.median();
  intervals_s_.add(dt_s);
  return known && dt_s > params_.gap_ratio * usual_s;
}

std::uint32_t FailAwareMonitor::reasonsFor(const FilterState& state, const SweepCondition& condition) const {
  std::uint32_t reasons = 0;
  const auto add = [&](bool holds, ReasonBit bit) { reasons |= holds ? static_cast<std::uint32_t>(bit) : 0u; };
  const bool first = state.dt_s <= 0.0;  // nothing to register against yet
  add(condition.empty, kReasonSweepEmpty);
  add(condition.incomplete, kReasonSweepIncomplete);
  add(condition.low_visibility, kReasonLowVisibility);
  add(condition.frozen, kReasonFrozenCloud);
  add(condition.time_jump, kReasonTimeJump);
  add(condition.time_field_refused, kReasonTimeFieldRefused);
  add(condition.point_times_contradicted, kReasonPointTimesContradicted);
  add(condition.no_answer, kReasonNoAnswer);
  add(condition.dropped_before > 0, kReasonDroppedSweeps);
  add(startPending() || (indicator_.started() && !growth_rate_.known() && !state.motionObserved()),
      kReasonMotionUnknown);
  if (first) return reasons;
  add(state.fusion.valid_inputs == 0, kReasonNoMeasurement);
  add(!state.measurement_applied, kReasonPredictionOnly);
  add(state.fusion.prediction_overruled, kReasonPredictionOverruled);
  add(state.fusion.disagreement_m > params_.disagreement_m, kReasonMeasurementsDisagree);
  add(condition.min_information_ratio < params_.min_information_ratio, kReasonWeakDirection);
  add(condition.point_missing, kReasonMissingIcpPoint);
  add(condition.plane_missing, kReasonMissingIcpPlane);
  add(condition.corners_missing, kReasonMissingCorners);
  return reasons;
}

Eigen::Matrix2d FailAwareMonitor::horizontalCovarianceOdom() const {
  if (!indicator_.started()) return Eigen::Matrix2d::Zero();
  const Eigen::Matrix3d R = mark_.T_odom.linear();
  return (R * mark_.since.covariance().topLeftCorner<3, 3>() * R.transpose()).topLeftCorner<2, 2>();
}

CovarianceGrowth FailAwareMonitor::growth(const FilterState& state, const DriftState& drift,
                                          const Pose& T_odom_mark) const {
  CovarianceGrowth growth;
  growth.covariance = horizontalBlock(drift.accumulated());
  growth.drivers = drift.drivers();
  const Eigen::Matrix<double, 6, 3> cross = drift.cross();
  growth.cross << cross.topRows<2>(), cross.bottomRows<1>();
  growth.transient = drift.transient.topLeftCorner<2, 2>();
  growth_rate_.describe(params_.min_information_ratio, growth);
  const Eigen::Matrix3d R_mark_cog = T_odom_mark.linear().transpose() * state.T_odom_cog.linear();
  growth.course_rad = rpyFromRotation(R_mark_cog).z();
  if (motion_.dt_s > 0.0) {
    growth.speed_mps = motion_.T_previous_now.translation().x() / motion_.dt_s;
    growth.yaw_rate_rps = rpyFromRotation(motion_.T_previous_now.linear()).z() / motion_.dt_s;
  }
  return growth;
}

std::optional<double> failureOrder(const TimeToFailure& time, const MonitorOutput& output) {
  if (!time.isKnown()) return std::nullopt;
  if (time.status != TimeToFailureStatus::kReached) return time.seconds;
  return -std::max(0.0, output.protection_level_m);
}

// From a predicted to a measured pose the increment takes back the prediction's error: that is no motion.
void FailAwareMonitor::keepMotion(const FilterState& state) {
  const bool from_prediction = state.measurement_applied && !(last_ && last_->measured) && motion_.dt_s > 0.0;
  if (!from_prediction && !state.clock_jump) motion_ = {state.T_previous_now, state.dt_s};
}

void FailAwareMonitor::begin(const FilterState& state, const Pose& T_odom_mark) {
  requested_ = Start::kNot;
  indicator_.start(state.time_s());
  error_unbounded_ = false;
  const DriftSinceMark since = covariance_.mark(T_odom_mark);
  mark_ = {T_odom_mark, state.stamp_s, since, since.state()};
}

// As if marked now: a mark takes over the error of the pose in the map, of the speed, and the biases.
void FailAwareMonitor::addStandby(const FilterState& state, MonitorOutput& output) const {
  if (!state.motionObserved() || !growth_rate_.known()) return;
  const DriftState at_mark = covariance_.mark(state.T_odom_cog).state();
  const CovariancePrediction prediction = predictor_.predict(growth(state, at_mark, state.T_odom_cog));
  output.standby_time_to_failure = prediction.time_to_failure;
  output.standby_state = stateFor(prediction.time_to_alarm, prediction.time_to_failure, params_.thresholds,
                                  output.reasons, motion_.speed_mps());
}

// Returns the time to the alarm. What a registration may take back at once counts in the radius and for the alarm, but
// not in the time: a heading that is unknown for one sweep would be taken for one that stays so.
TimeToFailure FailAwareMonitor::predictFailure(const FilterState& state, MonitorOutput& output) {
  CovarianceGrowth now = growth(state, mark_.since.state(), mark_.T_odom);
  if (error_unbounded_) now.covariance.diagonal().setConstant(std::numeric_limits<double>::infinity());
  const CovariancePrediction prediction = predictor_.predict(now);
  TimeToFailure time = prediction.time_to_failure;
  if (!growth_rate_.isBrieflyOpen()) {
    mark_.drift = mark_.since.state();
  } else if (time.status != TimeToFailureStatus::kReached) {
    time = predictor_.predict(growth(state, mark_.drift, mark_.T_odom)).time_to_failure;
  }
  output.time_to_failure_covariance = shortest_time_.add(time, state.dt_s);
  output.protection_level_m = prediction.radius_m;
  return prediction.time_to_alarm;
}

bool FailAwareMonitor::isWhereItWas(const FilterState& state) const {
  return !last_ || isSamePlace(state.T_odom_cog, last_->T_odom_cog);
}

// No state was lost in between; a filter that began anew counts from 0.
bool FailAwareMonitor::follows(const FilterState& state) const {
  if (!last_) return true;
  if (state.odom_reset_count < odom_reset_count_) return false;
  return !(state.dt_s > 0.0) || isSamePlace(state.T_odom_cog * state.T_previous_now.inverse(), last_->T_odom_cog);
}

// A pose that was set or a lost state ends what was known of the error; t1 begins where it was asked for.
bool FailAwareMonitor::enter(const FilterState& state) {
  keepMotion(state);
  const bool pose_set = state.odom_reset_count > odom_reset_count_;
  if (pose_set) {
    covariance_.enterOdom();
    if (indicator_.started()) start();
  }
  const bool states_lost = !pose_set && !follows(state);
  odom_reset_count_ = state.odom_reset_count;
  const bool all_observed = state.motionObserved() && state.dt_s <= kLongInterval_s && !states_lost;
  if (requested_ == Start::kWithNextSweep && !pose_set && !all_observed) begin(state, last_->T_odom_cog);
  if (states_lost || (last_ && !(state.dt_s >= 0.0))) error_unbounded_ = true;
  accumulate(state);
  const bool motion_known = state.motion_status != MotionStatus::kUnknown;
  last_ = Last{state.T_odom_cog, state.measurement_applied || !(state.dt_s > 0.0), motion_known};
  if (startPending() && (state.motionObserved() || (pose_set && motion_known))) begin(state, state.T_odom_cog);
  return states_lost;
}

void FailAwareMonitor::accumulate(const FilterState& state) {
  if (!last_ || !(state.dt_s > 0.0)) return;
  const Pose T_odom_previous = state.T_odom_cog * state.T_previous_now.inverse();
  const double speed_variance_before = covariance_.speedVariance();
  const bool added = covariance_.propagate(T_odom_previous, state.T_odom_cog, incrementOf(state)) &&
                     (!indicator_.started() || mark_.since.add(covariance_.lastStep()));
  if (!added) {
    error_unbounded_ = true;
    return;
  }
  // What a drive begins with is unknown, and says nothing of what follows.
  if (!state.motionObserved() && !growth_rate_.known()) return;
  growth_rate_.add(covariance_.rate(), {speed_variance_before, covariance_.speedVariance(), state.speed_error.kept},
                   state.dt_s);
}

MonitorOutput FailAwareMonitor::update(const FilterState& state, const SweepCondition& condition) {
  const bool states_lost = enter(state);
  growth_rate_.lookAhead(condition.incomplete ? InformationAhead() : condition.ahead);  // one side looks like a tunnel
  if (state.measurement_applied || state.dt_s <= 0.0 || !params_.indicator.measured_only) {
    indicator_.update(state.time_s(), state.sigma_yaw_rad, motion_.speed_mps());
  }

  MonitorOutput output;
  output.stamp_s = state.stamp_s;
  output.t1_stamp_s = mark_.t1_stamp_s;
  output.sigma_yaw_rad = std::isfinite(state.sigma_yaw_rad) ? state.sigma_yaw_rad : -1.0;
  output.reasons = reasonsFor(state, condition);
  if (growth_rate_.roadAhead().isWeak(params_.min_information_ratio)) output.reasons |= kReasonWeakRoadAhead;
  if (isAfterGap(state.dt_s) || states_lost) output.reasons |= kReasonDroppedSweeps;
  const InformationAhead ahead = growth_rate_.roadAhead().ahead();
  output.min_information_ahead = ahead.ratio;
  output.information_ahead_distance_m = ahead.distance_m;
  output.eta = indicator_.eta();
  output.eta_rate_per_s = indicator_.etaRate().value_or(-1.0);
  judge(state, output);
  if (!indicator_.started()) addStandby(state, output);
  return output;
}

void FailAwareMonitor::judge(const FilterState& state, MonitorOutput& output) {
  TimeToFailure time_to_alarm;
  if (indicator_.started()) {
    output.time_to_failure_indicator = indicator_.timeToFailure();
    output.covariance_since_start = mark_.since.covariance();
    output.sigma_x_m = std::sqrt(std::max(0.0, output.covariance_since_start(0, 0)));
    output.sigma_y_m = std::sqrt(std::max(0.0, output.covariance_since_start(1, 1)));
    if (growth_rate_.known()) time_to_alarm = predictFailure(state, output);
  }
  const bool eta_reached = output.time_to_failure_indicator.status == TimeToFailureStatus::kReached;
  if (eta_reached) output.reasons |= kReasonEtaThreshold;
  // While nothing is known of the error's growth, eta alone may only announce a failure, not the absence of one.
  if (growth_rate_.known() || eta_reached) {
    output.time_to_failure = combine(output.time_to_failure_indicator, output.time_to_failure_covariance);
  }
  if (output.protection_level_m >= params_.predictor.alert_limit_m) output.reasons |= kReasonCovarianceLimit;
  output.state =
      hysteresis_.update(stateFor(combine(output.time_to_failure_indicator, time_to_alarm), output.time_to_failure,
                                  params_.thresholds, output.reasons, motion_.speed_mps()));
}

}  // namespace fail_aware
