#include "fail_aware_lidar_odometry/core/filter/pose_filter.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "fail_aware_lidar_odometry/core/fusion/largest_values.hpp"
#include "fail_aware_lidar_odometry/core/geometry/degree.hpp"
#include "fail_aware_lidar_odometry/core/geometry/matrix6.hpp"
#include "fail_aware_lidar_odometry/core/geometry/rotation.hpp"
#include "fail_aware_lidar_odometry/core/parameters/check.hpp"
#include "fail_aware_lidar_odometry/core/stamp_difference.hpp"

namespace fail_aware {

namespace {

constexpr double kInitialAcross_mps = 1.0;  // standard deviations until a motion is known
constexpr double kInitialYawRate_rad_s = 0.3;
constexpr int kRotationSweeps = 2;  // in which what one leaves open is measured again
constexpr double kDoubtfulTurn_rad = 0.5 * kDegree;
constexpr double kDoubtfulSpeed_mps = 1.0;  // standard deviations of a motion that was kept over some sweeps
constexpr double kDoubtfulRate_rad_s = 0.1;
constexpr double kOpenVariance = 4.0;  // of the prediction's: a measurement that says less leaves it open

Matrix6d toPoseCovariance(const Matrix6d& state_covariance, const Vector6d& state) {
  const Matrix6d J = poseFromStateJacobian(state.tail<3>());
  return J * state_covariance * J.transpose();
}

bool isConfirmed(const FilterState& state) { return state.corrected && state.fusion.confirmed; }

// Over a long interval a single measurement is no better than the prediction that it started from.
bool isAsPredicted(const FilterState& state) {
  return !state.corrected || (state.dt_s > kLongInterval_s && !isConfirmed(state));
}

// What leaves them at the prediction (corners are seen from above) must not turn the reference: all that is measured in
// it later would tilt with it.
bool observesTilt(const FusionResult& fusion, const Matrix6d& predicted_P) {
  return fusion.R(3, 3) < kOpenVariance * predicted_P(3, 3) && fusion.R(4, 4) < kOpenVariance * predicted_P(4, 4);
}

std::optional<double> planesFittingShare(const std::vector<FusionInput>& inputs) {
  const auto planes = std::find_if(inputs.begin(), inputs.end(), [](const FusionInput& input) {
    return input.name == kIcpPointToPlane && input.measurement != nullptr && input.measurement->ok();
  });
  if (planes == inputs.end()) return std::nullopt;
  return planes->measurement->inlier_share;
}

// An empty sweep, or no answer of those who look at it: nothing that the next sweep could be registered to.
bool isUsableStart(const std::vector<FusionInput>& inputs) {
  const auto is_icp = [](const FusionInput& input) {
    return input.name == kIcpPointToPoint || input.name == kIcpPointToPlane;
  };
  const auto has_points = [&](const FusionInput& input) {
    return is_icp(input) && input.measurement != nullptr &&
           input.measurement->status != MeasurementStatus::kTooFewPoints;
  };
  return std::none_of(inputs.begin(), inputs.end(), is_icp) || std::any_of(inputs.begin(), inputs.end(), has_points);
}

}  // namespace

OdometryIncrement incrementOf(const FilterState& state) {
  OdometryIncrement increment{state.increment_covariance, state.unobserved_covariance, state.dt_s,
                              state.speed_error,          isAsPredicted(state),        {},
                              state.reference_epoch};
  if (isConfirmed(state)) increment.confirmed = toPoseCovariance(state.fusion.R, state.fusion.z);
  return increment;
}

void PoseFilter::Params::validate() const {
  requireNotNegative("initial_speed_sigma_mps", initial_speed_sigma_mps);
  requirePositive("initial_sigma_m", initial_sigma_m);
  requirePositive("initial_sigma_deg", initial_sigma_deg);
  requirePositive("max_speed_mps", max_speed_mps);
  requirePositive("max_yaw_rate_rps", max_yaw_rate_rps);
  requirePositive("increment_scale", increment_scale);
  requirePositive("coasting_increment_factor", coasting_increment_factor);
  requireNotNegative("increment_floor_m", increment_floor_m);
  requireNotNegative("increment_per_metre_m", increment_per_metre_m);
  requireNotNegative("increment_floor_deg", increment_floor_deg);
  plausibility.validate();
  coasting.validate();
}

PoseFilter::PoseFilter(const Params& params, const Ukf::Params& ukf, const VehicleModel& model,
                       const MotionHistory::Params& history, const RoadPlaneEstimator::Params& road,
                       const MeasurementFusion::Params& fusion)
    : params_(params),
      model_(model),
      ukf_(ukf),
      history_(history),
      road_(model.vehicle(), road),
      fusion_(fusion),
      coasting_(params.coasting),
      plausibility_(params.plausibility) {
  params_.validate();
  reset(Pose::Identity());
}

void PoseFilter::reset(const Pose& T_odom_cog) {
  Vector6d sigmas;
  sigmas.head<3>().setConstant(params_.initial_sigma_m);
  sigmas.tail<3>().setConstant(params_.initial_sigma_deg * kDegree);
  ukf_.reset(vectorFromPose(T_odom_cog), sigmas.cwiseAbs2().asDiagonal());
  history_.clear();
  motion_ = MotionDerivatives();
  coasting_.reset({params_.initial_speed_sigma_mps, kInitialAcross_mps, kInitialAcross_mps}, kInitialYawRate_rad_s);
  road_.clear();
  started_ = false;
  plausibility_.clear();
  last_measured_ = previous_measured_ = false;
  placement_.clear();
  tells_no_motion_ = told_no_motion_ = false;
  corrected_sweeps_ = 0;
  prediction_ = SweepPrediction();
  const int odom_epoch = state_.odom_epoch, reference_epoch = state_.reference_epoch;
  state_ = FilterState();
  state_.odom_epoch = odom_epoch;
  state_.reference_epoch = reference_epoch;
  state_.T_odom_cog = T_odom_cog;
  state_.covariance = ukf_.covariance();
}

namespace {

/// A state covariance at `from`, turned with odom by R_new_old to the same body at `to`.
Matrix6d turned(const Matrix6d& P, const Vector6d& from, const Vector6d& to, const Eigen::Matrix3d& R_new_old) {
  const Matrix6d pose_covariance = rotateCovariance(toPoseCovariance(P, from), R_new_old);
  const Matrix6d J_inverse = inverseOf(poseFromStateJacobian(to.tail<3>()));
  const Matrix6d turned = J_inverse * pose_covariance * J_inverse.transpose();
  return 0.5 * (turned + turned.transpose());
}

}  // namespace

bool PoseFilter::setPose(const Pose& T_odom_cog) {
  if (!isFinite(T_odom_cog)) return false;
  const Vector6d before = ukf_.state(), after = vectorFromPose(T_odom_cog);
  const Pose T_new_old = T_odom_cog * poseFromVector(before).inverse();
  const Matrix6d P = turned(ukf_.covariance(), before, after, T_new_old.linear());
  if (!ukf_.reset(after, P)) return false;
  history_.move(T_new_old);
  road_.turn(T_new_old.linear());
  const Eigen::Matrix3d rates_after_before =
      fixedAxisFromRpyRates(after.tail<3>()).inverse() * T_new_old.linear() * fixedAxisFromRpyRates(before.tail<3>());
  motion_.rpy_rates_rad_s = rates_after_before * motion_.rpy_rates_rad_s;
  motion_.rpy_accelerations_rad_s2 = rates_after_before * motion_.rpy_accelerations_rad_s2;

  const Vector6d z = state_.fusion.z;
  state_.fusion.z = vectorFromPose(T_new_old * poseFromVector(z));
  state_.fusion.R = turned(state_.fusion.R, z, state_.fusion.z, T_new_old.linear());
  state_.T_odom_cog = T_odom_cog;
  state_.covariance = ukf_.covariance();
  state_.sigma_yaw_rad = std::sqrt(state_.covariance(5, 5));
  ++state_.odom_epoch;
  placement_.setPose();
  plausibility_.clear();
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
  prediction_.odom_epoch = state_.odom_epoch;
  if (started_) {
    prediction_.dt_s = dt;
    prediction_.motion_known = corrected_sweeps_ >= 2;
    Matrix6d Q = model_.processNoise(dt, ukf_.state()[5]);
    const Eigen::Matrix3d R_odom_body = state_.T_odom_cog.linear();
    const auto inOdom = [&](const Eigen::Matrix4d& increment) -> Eigen::Matrix3d {  // of its position
      return R_odom_body * increment.topLeftCorner<3, 3>() * R_odom_body.transpose();
    };
    double uncertain_yaw = 0.0;
    if (!prediction_.motion_known) {
      // only the speed along the road is that uncertain
      const double sigma = params_.initial_speed_sigma_mps * dt;
      const Eigen::Vector2d forward(std::cos(ukf_.state()[5]), std::sin(ukf_.state()[5]));
      Q.topLeftCorner<2, 2>() += sigma * sigma * forward * forward.transpose();
    } else if (coasting_.active()) {
      const Eigen::Matrix4d uncertain = coasting_.incrementCovariance(dt);
      Q.topLeftCorner<3, 3>() += inOdom(uncertain);
      uncertain_yaw = uncertain(3, 3);
    }
    if (prediction_.motion_known && interval_sigma_s_ > 0.0) {  // how far it went is known no better than for how long
      const Eigen::Vector3d way = R_odom_body * motion_.velocity_body_mps * interval_sigma_s_;
      const double turn_rad = motion_.rpy_rates_rad_s.z() * interval_sigma_s_;
      Q.topLeftCorner<3, 3>() += way * way.transpose();
      Q(5, 5) += turn_rad * turn_rad;
    }
    process_noise_ = Q;
    // not for the filter: a heading that it thinks uncertain would shorten the unscented mean of every step
    process_noise_(5, 5) += uncertain_yaw;
    if (prediction_.motion_known && dt > kLongInterval_s) {  // the model's noise is that of consecutive sweeps
      const Eigen::Matrix4d driven = coasting_.drivenCovariance(dt, state_.dt_s, motion_.velocity_body_mps.norm());
      Q.topLeftCorner<3, 3>() += inOdom(driven);
      Q(5, 5) += driven(3, 3);
    }
    if (!state_.corrected) {
      // Roll and pitch do not walk away from the road: at most one step's noise. Added up over many sweeps it would
      // shorten the unscented mean of every step by cos(pitch), a tenth of the speed.
      const Matrix6d& P = ukf_.covariance();
      for (int i = 3; i < 5; ++i) Q(i, i) = std::max(0.0, Q(i, i) - P(i, i));
    }
    ukf_.predict([&](const Vector6d& x) { return model_.predict(x, motion_, dt, road_.plane()); }, Q);
  }
  prediction_.T_odom_cog = poseFromVector(ukf_.state());
  prediction_.covariance = toPoseCovariance(ukf_.covariance(), ukf_.state());
  prediction_.sigma_yaw_rad = std::sqrt(ukf_.covariance()(5, 5));
  prediction = prediction_;
  return true;
}

const FilterState& PoseFilter::correct(const std::vector<FusionInput>& measurements, double middle_s) {
  const Pose T_odom_cog_previous = state_.T_odom_cog;
  FilterState next;
  next.stamp_s = prediction_.stamp_s;
  next.stamp_error_s = prediction_.stamp_error_s;
  next.dt_s = prediction_.dt_s;
  next.set_back_s = prediction_.set_back_s;
  next.odom_epoch = state_.odom_epoch;
  next.reference_epoch = state_.reference_epoch;
  next.started = started_ || isUsableStart(measurements);
  const Matrix6d predicted_P = ukf_.covariance();
  std::vector<FusionInput> inputs = measurements;
  const Vector6d predicted = ukf_.state();
  const bool doubted = doubtPrediction(inputs);
  next.fusion = fusion_.fuse(ukf_.state(), ukf_.covariance(), inputs);
  if (next.fusion.has_measurement) {
    next.corrected = ukf_.correct(next.fusion.z, next.fusion.R);
    next.filter_nis = ukf_.nis();
  }
  next.interval_wrong = doubted && next.corrected;
  next.fusion.prediction_overruled = next.fusion.prediction_overruled || next.interval_wrong;
  next.T_odom_cog = poseFromVector(ukf_.state());
  next.covariance = ukf_.covariance();
  next.sigma_yaw_rad = std::sqrt(next.covariance(5, 5));
  if (started_) {
    next.T_previous_now = T_odom_cog_previous.inverse() * next.T_odom_cog;
    setIncrementCovariance(prediction_, next);
    const bool is_compared = next.corrected && !doubted && prediction_.motion_known && next.dt_s <= kLongInterval_s &&
                             (last_measured_ || previous_measured_);
    const Vector6d innovation = is_compared ? stateDifference(next.fusion.z, predicted) : Vector6d::Zero().eval();
    told_no_motion_ = tells_no_motion_;
    const bool tells_no_motion = addDoubt(inputs, innovation, next);
    if (next.corrected) tells_no_motion_ = tells_no_motion;
  }
  if (!next.started) {
    state_ = next;
    return state_;
  }
  if (next.corrected || !started_) ++corrected_sweeps_;  // the first sweep defines the start pose
  ReferencePlacement::Sweep sweep;
  sweep.motion_known = prediction_.motion_known;
  sweep.follows = last_measured_ && next.dt_s <= kLongInterval_s;
  sweep.observed = next.corrected && observesTilt(next.fusion, predicted_P);
  sweep.tells_no_motion = tells_no_motion_;
  const ReferencePlacement::Placement placement = placement_.add(measurements, sweep);
  next.placed = placement.placed;
  if (placement.anew) ++next.reference_epoch;
  if (placement.out_of_sight) plausibility_.clear();
  const bool measured = next.corrected || placement.begins;
  if (placement.begins || next.interval_wrong || (told_no_motion_ && !tells_no_motion_)) history_.clear();
  started_ = true;
  previous_measured_ = last_measured_;
  last_measured_ = measured;
  state_ = next;
  if (measured) remember(middle_s);
  updateMotion();
  if (measured) road_.update(next.time_s(), ukf_.state(), motion_);
  state_.motion_observed = state_.corrected && prediction_.motion_known && !coasting_.active();
  return state_;
}

FilterState PoseFilter::stateAsDriven() const {
  FilterState state = state_;
  if (!prediction_.motion_known && !state.corrected) state.dt_s = 0.0;
  if (!state.interval_wrong) return state;
  state.dt_s = std::min(state.dt_s, kLongInterval_s);  // in which it turns by less than half a turn
  Vector6d twist_cog;
  twist_cog << motion_.velocity_body_mps, 0.0, 0.0, motion_.rpy_rates_rad_s.z();
  state.T_previous_now = expSe3(twist_cog * state.dt_s);
  const double way_sigma_m = kDoubtfulSpeed_mps * state.dt_s, turn_sigma_rad = kDoubtfulRate_rad_s * state.dt_s;
  state.increment_covariance.diagonal().head<3>().array() += way_sigma_m * way_sigma_m;
  state.increment_covariance.diagonal().tail<3>().array() += turn_sigma_rad * turn_sigma_rad;
  return state;
}

// The prediction went by another interval: it is as wrong as that, and so is what began at it and was found nowhere
// else.
bool PoseFilter::doubtPrediction(std::vector<FusionInput>& inputs) {
  const auto doubts = [](const FusionInput& input) {
    return input.measurement != nullptr && input.measurement->ok() && input.measurement->interval_doubted &&
           !input.external;
  };
  const auto doubting = std::find_if(inputs.begin(), inputs.end(), doubts);
  if (doubting == inputs.end()) return false;
  const Vector6d error = stateDifference(vectorFromPose(doubting->measurement->T_odom_cog), ukf_.state());
  if (error.head<3>().norm() > kFarthestOff_m) return false;
  ukf_.reset(ukf_.state(), ukf_.covariance() + error * error.transpose());
  for (FusionInput& input : inputs) {
    if (!input.external && !doubts(input)) input.measurement = nullptr;
  }
  return true;
}

// The pose in the sweep's middle, by the motion that the sweep was corrected for.
void PoseFilter::remember(double middle_s) {
  newest_middle_s_ = 0.0;
  Pose T_odom_cog = state_.T_odom_cog;
  // the first motion, found over more than one interval, is not that of the last one
  const bool knows_motion = prediction_.motion_known || previous_measured_;
  if (state_.corrected && knows_motion && state_.dt_s > 0.0 && std::isfinite(middle_s)) {
    const Pose T_previous_now = prediction_.motion_known
                                    ? prediction_.T_odom_cog_previous.inverse() * prediction_.T_odom_cog
                                    : state_.T_previous_now;  // the motion that was searched for
    T_odom_cog = T_odom_cog * expSe3(logSe3(T_previous_now) * (middle_s / state_.dt_s));
    newest_middle_s_ = middle_s;
  }
  history_.push(state_.time_s() + newest_middle_s_, T_odom_cog);
}

// Carried from the newest sweep's middle to the stamp; as in the history, z, roll and pitch are not.
MotionDerivatives PoseFilter::historyDerivatives() const {
  MotionDerivatives motion = history_.derivatives();
  motion.velocity_body_mps.head<2>() -= newest_middle_s_ * motion.acceleration_body_mps2.head<2>();
  motion.rpy_rates_rad_s.z() -= newest_middle_s_ * motion.rpy_accelerations_rad_s2.z();
  return motion;
}

Coasting::Measured PoseFilter::measuredMotion() const {
  const Eigen::Matrix3d R_odom_body = state_.T_odom_cog.linear();
  const Pose T_previous_measured = prediction_.T_odom_cog_previous.inverse() * poseFromVector(state_.fusion.z);
  const double yaw_previous_rad = rpyFromRotation(prediction_.T_odom_cog_previous.linear()).z();
  Coasting::Measured measured;
  if (previous_measured_) {
    measured.velocity_mps = logSe3(T_previous_measured).head<3>() / state_.dt_s;
    measured.yaw_rate_rad_s = wrapAngle(state_.fusion.z[5] - yaw_previous_rad) / state_.dt_s;
  } else {  // the way from a prediction holds its error; that from the last measured pose does not
    measured.velocity_mps = historyDerivatives().velocity_body_mps;
    measured.yaw_rate_rad_s = historyDerivatives().rpy_rates_rad_s.z();
  }
  measured.R =
      R_odom_body.transpose() * toPoseCovariance(state_.fusion.R, state_.fusion.z).topLeftCorner<3, 3>() * R_odom_body;
  measured.yaw_variance = state_.fusion.R(5, 5);
  return measured;
}

void PoseFilter::coast(const MotionDerivatives& last, const Coasting::Measured* measured) {
  Coasting::Motion before;
  before.velocity_mps = last.velocity_body_mps;
  before.yaw_rate_rad_s = last.rpy_rates_rad_s.z();
  if (measured) {
    before.acceleration_mps2 = last.acceleration_body_mps2;
    before.yaw_acceleration_rad_s2 = last.rpy_accelerations_rad_s2.z();
  }
  const Coasting::Motion motion = coasting_.coast(before, state_.dt_s, measured);
  motion_.velocity_body_mps = motion.velocity_mps;
  motion_.acceleration_body_mps2 = motion.acceleration_mps2;
  motion_.rpy_rates_rad_s.z() = motion.yaw_rate_rad_s;
  motion_.rpy_accelerations_rad_s2.z() = motion.yaw_acceleration_rad_s2;
}

// What nothing of the speed can be taken from tells the heading still, roughly: all that is seen turns about the vehicle.
Coasting::Measured PoseFilter::measuredTurn() const {
  Coasting::Measured measured = measuredMotion();
  measured.R = kLargestVariance * Eigen::Matrix3d::Identity();
  measured.yaw_variance += kDoubtfulTurn_rad * kDoubtfulTurn_rad;
  return measured;
}

void PoseFilter::updateMotion() {
  const MotionDerivatives last = motion_;
  const bool told = state_.corrected && !state_.interval_wrong && !tells_no_motion_ && !told_no_motion_;
  if (told) {
    motion_ = historyDerivatives();
  } else {
    motion_.rpy_accelerations_rad_s2.setZero();
    motion_.rpy_rates_rad_s.head<2>().setZero();
    motion_.acceleration_body_mps2.setZero();
  }
  if (state_.dt_s > 0.0) {
    if (!state_.corrected) {
      coast(last, nullptr);
    } else if (!state_.interval_wrong && (tells_no_motion_ || told_no_motion_)) {
      MotionDerivatives steady = last;
      steady.acceleration_body_mps2.setZero();
      const Coasting::Measured turn = measuredTurn();
      coast(steady, previous_measured_ ? &turn : nullptr);
    } else if (told) {
      const Coasting::Measured measured = measuredMotion();
      if (coasting_.settles(measured)) {
        coasting_.observed(measured, state_.dt_s);
      } else {
        coast(last, &measured);
      }
    }
    state_.speed_error = coasting_.speedError();
  }
  const double speed = motion_.velocity_body_mps.norm();
  if (speed > params_.max_speed_mps) motion_.velocity_body_mps *= params_.max_speed_mps / speed;
  double& yaw_rate = motion_.rpy_rates_rad_s.z();
  yaw_rate = std::clamp(yaw_rate, -params_.max_yaw_rate_rps, params_.max_yaw_rate_rps);
}

bool PoseFilter::addDoubt(const std::vector<FusionInput>& inputs, const Vector6d& innovation, FilterState& state) {
  MotionPlausibility::Sweep sweep;
  sweep.dt_s = state.dt_s;
  sweep.undecided_m = state.fusion.undecided_m;
  sweep.innovation_m = coasting_.active() ? 0.0 : innovation.head<2>().norm();
  sweep.time_sigma_m = interval_sigma_s_ * motion_.velocity_body_mps.norm();
  sweep.turn_rad = innovation.tail<3>().norm();
  sweep.fitting_share = planesFittingShare(inputs);
  const MotionPlausibility::Doubt doubt = plausibility_.add(sweep);
  // after a gap the covariance would begin with the R of what is confirmed
  if (doubt.unbelievable) state.fusion.confirmed = false;
  for (Matrix6d* covariance : {&state.increment_covariance, &state.unobserved_covariance}) {
    covariance->diagonal().head<2>().array() += doubt.sigma_m * doubt.sigma_m;
    (*covariance)(5, 5) += doubt.sigma_yaw_rad * doubt.sigma_yaw_rad;
  }
  return doubt.tells_no_motion;
}

void PoseFilter::setIncrementCovariance(const SweepPrediction& prediction, FilterState& state) const {
  // One Kalman step from a pose known exactly, K = Q (Q + R)^-1: the prediction's part (I - K) Q (I - K)^T, along the
  // directions that R does not observe all of Q, and the measurement's part K R K^T.
  const Matrix6d& Q = process_noise_;
  Matrix6d from_prediction = Q, lasting = Q, from_measurement = Matrix6d::Zero();
  if (state.interval_wrong) {  // the prediction tells nothing of it
    from_prediction.setZero();
    lasting.setZero();
    from_measurement = state.fusion.R;
  } else if (!isAsPredicted(state)) {
    const Matrix6d sum = Q + state.fusion.R;
    const Matrix6d K = solutionOf(sum, Q).transpose();
    const Matrix6d left = Matrix6d::Identity() - K;
    from_prediction = left * Q * left.transpose();
    from_measurement = K * state.fusion.R * K.transpose();
    // A rotation that this sweep leaves open is measured again by the next ones, against the same map.
    Matrix6d left_open = left, rotation = left;
    for (int sweep = 1; sweep < kRotationSweeps; ++sweep) rotation = (rotation * left).eval();
    left_open.bottomRows<3>() = rotation.bottomRows<3>();
    lasting = left_open * Q * left_open.transpose();
  }
  const Vector6d x = vectorFromPose(state.T_odom_cog);
  const Eigen::Matrix3d R_previous_odom = prediction.T_odom_cog_previous.linear().transpose();
  const double scale = params_.increment_scale * (coasting_.active() ? params_.coasting_increment_factor : 1.0);
  const auto aboutPrevious = [&](const Matrix6d& C) {
    const Matrix6d scaled = 0.5 * scale * (C + C.transpose());
    Matrix6d turned = rotateCovariance(toPoseCovariance(scaled, x), R_previous_odom);
    // rounding, where variances differ by many orders of magnitude
    const double least = turned.diagonal().minCoeff();
    if (least < 0.0) turned.diagonal().array() -= least;
    return turned;
  };
  state.unobserved_covariance = aboutPrevious(lasting);
  state.increment_covariance = aboutPrevious(from_prediction) + aboutPrevious(from_measurement);
  const double floor_m =
      params_.increment_floor_m + params_.increment_per_metre_m * state.T_previous_now.translation().norm();
  const double floor_rad = params_.increment_floor_deg * kDegree;
  state.increment_covariance.diagonal().head<3>().array() += floor_m * floor_m;
  state.increment_covariance.diagonal().tail<3>().array() += floor_rad * floor_rad;
}

}  // namespace fail_aware
