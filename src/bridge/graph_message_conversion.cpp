#include "bridge/graph_message_conversion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/estimation/external_pose.hpp"
#include "core/estimation/largest_values.hpp"
#include "core/estimation/stamp_order.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"

namespace fail_aware {

namespace {

constexpr double kFarthest_m = 1e3 * kFarthestPose_m;  // no drive that starts at an accepted pose gets that far

/// For values from other packages' messages that this package's messages pass on.
double finiteOr0(double value) { return std::isfinite(value) ? value : 0.0; }

/// A number that the enumeration does not have leaves `value` unchanged: unknown, or skipped.
template <class Enumeration>
void take(std::uint8_t number, Enumeration& value) {
  if (number <= static_cast<std::uint8_t>(lastOf(value))) value = static_cast<Enumeration>(number);
}

template <class Message>  // SweepPrediction, FilterState
double setBack_s(const Message& message) {
  return std::clamp(finiteOr0(message.set_back), 0.0, kFarAhead_s);
}

constexpr std::uint8_t kNotArrived = messages::FilterState::NOT_ARRIVED;

InformationAhead aheadSeen(const SweepAccount& account) {
  for (const SweepAccount::Source& source : account.sources) {
    const bool sees = source.name == kIcpPointToPlane && source.measurement && source.measurement->ok();
    if (sees) return source.measurement->ahead;
  }
  return {};
}

static_assert(static_cast<int>(MeasurementStatus::kOk) == messages::PoseMeasurement::OK, "");
static_assert(static_cast<int>(MeasurementStatus::kNoReference) == messages::PoseMeasurement::NO_REFERENCE, "");
static_assert(static_cast<int>(MeasurementStatus::kTooFewPoints) == messages::PoseMeasurement::TOO_FEW_POINTS, "");
static_assert(static_cast<int>(MeasurementStatus::kNotConverged) == messages::PoseMeasurement::NOT_CONVERGED, "");
static_assert(static_cast<int>(MeasurementStatus::kDegenerate) == messages::PoseMeasurement::DEGENERATE, "");
static_assert(static_cast<int>(MeasurementStatus::kTooFewCorners) == messages::PoseMeasurement::TOO_FEW_CORNERS, "");

void describeFusion(const FilterState& state, std::size_t sources, messages::FilterState& message) {
  const FusionResult& fusion = state.fusion;
  message.measurement_weights = fusion.weights;
  message.measurement_nis = fusion.nis;
  message.measurement_weights.resize(sources, 0.0);
  message.measurement_nis.resize(sources, -1.0);
  message.has_measurement = fusion.has_measurement;
  std::copy(fusion.z.data(), fusion.z.data() + 6, message.fused_state.begin());
  message.fused_covariance = toCovarianceMessage(fusion.R);
  message.fused_nis = state.filter_nis;
  message.all_gated_out = fusion.all_gated_out;
  message.prediction_overruled = fusion.prediction_overruled;
  message.prediction_invalid = fusion.prediction_invalid;
  message.disagreement = fusion.disagreement_m;
  message.disagreement_yaw = fusion.disagreement_yaw_rad;
  message.confirmed = fusion.confirmed;
  message.valid_inputs = static_cast<std::uint32_t>(fusion.valid_inputs);
  message.invalid_inputs = static_cast<std::uint32_t>(fusion.invalid_inputs);
}

}  // namespace

messages::SweepPrediction toMessage(const SweepTask& task, const std_msgs::Header& header,
                                    const ros::Time& previous_stamp) {
  messages::SweepPrediction message;
  message.header = header;
  message.previous_stamp = task.first() ? ros::Time() : previous_stamp;
  message.stamp_error = task.prediction.stamp_error_s;
  message.period = task.prediction.period_s;
  message.dt = task.prediction.dt_s;
  message.previous_pose = toPoseMessage(task.prediction.T_odom_cog_previous);
  message.pose = toPoseMessage(task.prediction.T_odom_cog);
  message.covariance = toCovarianceMessage(task.prediction.covariance);
  message.sigma_yaw = task.prediction.sigma_yaw_rad;
  message.motion_status = static_cast<std::uint8_t>(task.prediction.motion_status);
  message.lidar_in_cog = toPoseMessage(task.T_cog_lidar);
  message.odom_reset_count = task.prediction.odom_reset_count;
  message.set_back = task.prediction.set_back_s;
  message.lidar_frame = task.lidar_frame;
  return message;
}

std::optional<SweepTask> fromMessage(const messages::SweepPrediction& message) {
  const std::optional<Pose> previous = fromMessage(message.previous_pose), pose = fromMessage(message.pose),
                            lidar = fromMessage(message.lidar_in_cog);
  if (!previous || !pose || !lidar) return std::nullopt;
  const auto is_near = [](const Pose& T) { return T.translation().cwiseAbs().maxCoeff() <= kFarthest_m; };
  if (!is_near(*previous) || !is_near(*pose) || !is_near(*lidar)) return std::nullopt;
  SweepTask task;
  task.prediction.stamp_s = message.header.stamp.toSec();
  task.prediction.stamp_error_s = finiteOr0(message.stamp_error);
  task.prediction.period_s = finiteOr0(message.period);
  task.prediction.dt_s = message.dt;
  task.prediction.T_odom_cog_previous = *previous;
  task.prediction.T_odom_cog = *pose;
  task.prediction.covariance = fromMessage(message.covariance);
  task.prediction.sigma_yaw_rad = message.sigma_yaw;
  take(message.motion_status, task.prediction.motion_status);
  task.T_cog_lidar = *lidar;
  task.prediction.odom_reset_count = message.odom_reset_count;
  task.prediction.set_back_s = setBack_s(message);
  task.lidar_frame = message.lidar_frame;
  return task;
}

messages::PoseMeasurement toMessage(const Measurement& measurement, const std::string& source,
                                    const std_msgs::Header& header) {
  messages::PoseMeasurement message;
  message.header = header;
  message.source = source;
  message.status = static_cast<std::uint8_t>(measurement.status);
  message.pose = toPoseMessage(measurement.T_odom_cog);
  message.covariance = toCovarianceMessage(measurement.covariance);
  message.rms_residual = measurement.rms_residual_m;
  message.inlier_ratio = measurement.inlier_ratio;
  message.inliers = static_cast<std::uint32_t>(measurement.inliers);
  message.iterations = static_cast<std::uint32_t>(std::max(0, measurement.iterations));
  message.seed_spread = measurement.seed_spread_m;
  message.degenerate_directions = static_cast<std::uint8_t>(std::clamp(measurement.degenerate_directions, 0, 6));
  message.min_information_ratio = measurement.min_information_ratio;
  message.min_information_ahead = measurement.ahead.ratio;
  message.information_ahead_distance = measurement.ahead.distance_m;
  message.clock_jump_suspected = measurement.clock_jump_suspected;
  message.sweep_points = -1;
  return message;
}

Measurement fromMessage(const messages::PoseMeasurement& message) {
  Measurement measurement;
  if (message.status <= messages::PoseMeasurement::TOO_FEW_CORNERS) {
    measurement.status = static_cast<MeasurementStatus>(message.status);
  }
  const std::optional<Pose> pose = fromMessage(message.pose);
  measurement.T_odom_cog = pose.value_or(Pose::Identity());
  if (!pose) measurement.T_odom_cog.translation().setConstant(std::numeric_limits<double>::quiet_NaN());
  measurement.covariance = fromMessage(message.covariance);
  measurement.rms_residual_m = finiteOr0(message.rms_residual);
  measurement.inlier_ratio = finiteOr0(message.inlier_ratio);
  measurement.inliers = message.inliers;
  measurement.iterations = static_cast<int>(message.iterations);
  measurement.seed_spread_m = finiteOr0(message.seed_spread);
  measurement.degenerate_directions = message.degenerate_directions;
  measurement.min_information_ratio = finiteOr0(message.min_information_ratio);
  measurement.ahead = aheadOf(message.min_information_ahead, message.information_ahead_distance);
  measurement.clock_jump_suspected = message.clock_jump_suspected != 0;
  return measurement;
}

InformationAhead aheadOf(double ratio, double distance_m) {
  const InformationAhead ahead{ratio, distance_m};
  return ahead.isValid() && ahead.known() && distance_m > 0.0 ? ahead : InformationAhead();
}

messages::SweepCheck toMessage(const SweepFindings& findings, std::size_t points, const std_msgs::Header& header) {
  messages::SweepCheck message;
  message.header = header;
  message.points = static_cast<std::int32_t>(points);
  message.incomplete = findings.incomplete;
  message.low_visibility = findings.low_visibility;
  message.frozen = findings.frozen;
  message.time_jump = findings.time_jump;
  message.time_field_refused = findings.time_field_refused;
  message.point_times_contradicted = findings.point_times_contradicted;
  message.azimuth_coverage = findings.azimuth_coverage;
  message.view_range = findings.view_range_m;
  message.repetitions = static_cast<std::uint32_t>(findings.repetitions);
  message.middle = findings.middle_s;
  message.revolution = findings.revolution_s;
  const Eigen::Matrix2d tilt = findings.tilt_moment.value_or(Eigen::Matrix2d::Constant(std::nan("")));
  message.tilt_moment = {tilt(0, 0), tilt(0, 1), tilt(1, 1)};
  return message;
}

SweepFindings fromMessage(const messages::SweepCheck& message) {
  SweepFindings findings;
  findings.incomplete = message.incomplete != 0;
  findings.low_visibility = message.low_visibility != 0;
  findings.frozen = message.frozen != 0;
  findings.time_jump = message.time_jump != 0;
  findings.time_field_refused = message.time_field_refused != 0;
  findings.point_times_contradicted = message.point_times_contradicted != 0;
  findings.azimuth_coverage = message.azimuth_coverage;
  findings.view_range_m = finiteOr0(message.view_range);
  findings.repetitions = static_cast<int>(message.repetitions);
  findings.middle_s = message.middle;
  findings.revolution_s = finiteOr0(message.revolution);
  Eigen::Matrix2d tilt;
  tilt << message.tilt_moment[0], message.tilt_moment[1], message.tilt_moment[1], message.tilt_moment[2];
  if (tilt.allFinite()) findings.tilt_moment = tilt;
  return findings;
}

messages::FilterState toMessage(const FilterState& state, const SweepAccount& account, const std_msgs::Header& header) {
  messages::FilterState message;
  message.header = header;
  message.stamp_error = state.stamp_error_s;
  message.dt = state.dt_s;
  message.pose = toPoseMessage(state.T_odom_cog);
  message.covariance = toCovarianceMessage(state.covariance);
  message.sigma_yaw = state.sigma_yaw_rad;
  message.measurement_applied = state.measurement_applied;
  message.started = state.started;
  message.motion_status = static_cast<std::uint8_t>(state.motion_status);
  message.increment = toPoseMessage(state.T_previous_now);
  message.increment_covariance = toCovarianceMessage(state.increment_covariance);
  message.motion_covariance = toCovarianceMessage(state.motion_covariance);
  message.registration_covariance = toCovarianceMessage(state.registration_covariance);
  message.registered = state.registered;
  message.doubt = state.doubt.sigma_m;
  message.doubt_yaw = state.doubt.sigma_yaw_rad;
  message.speed_variance = state.speed_error.variance_m2_s2;
  message.speed_kept = state.speed_error.kept;
  message.clock_jump = state.clock_jump;
  message.set_back = state.set_back_s;
  message.view_range = state.view_range_m;
  message.odom_reset_count = state.odom_reset_count;
  message.map_update = static_cast<std::uint8_t>(state.map_update);
  const InformationAhead ahead = aheadSeen(account);
  message.min_information_ahead = ahead.ratio;
  message.information_ahead_distance = ahead.distance_m;
  for (const SweepAccount::Source& source : account.sources) {
    message.measurement_names.push_back(source.name);
    message.measurement_status.push_back(source.measurement ? static_cast<std::uint8_t>(source.measurement->status)
                                                            : kNotArrived);
    message.min_information_ratio.push_back(source.measurement ? source.measurement->min_information_ratio : 0.0);
    message.deadline_missed = message.deadline_missed || (source.awaited && !source.measurement);
  }
  describeFusion(state, account.sources.size(), message);
  message.sweep_points = account.sweep_points;
  message.dropped_before = static_cast<std::uint32_t>(std::max(0, account.dropped_before));
  message.deadline_missed = message.deadline_missed || !account.findings;
  const SweepFindings findings = account.findings.value_or(SweepFindings());
  message.sweep_incomplete = findings.incomplete;
  message.sweep_low_visibility = findings.low_visibility;
  message.sweep_frozen = findings.frozen;
  message.sweep_time_field_refused = findings.time_field_refused;
  message.sweep_point_times_contradicted = findings.point_times_contradicted;
  message.time_jump = findings.time_jump;
  return message;
}

std::optional<FilterState> fromMessage(const messages::FilterState& message) {
  const std::optional<Pose> pose = fromMessage(message.pose), increment = fromMessage(message.increment);
  if (!pose || !increment) return std::nullopt;
  FilterState state;
  state.stamp_s = message.header.stamp.toSec();
  state.stamp_error_s = finiteOr0(message.stamp_error);
  state.dt_s = message.dt;
  state.T_odom_cog = *pose;
  state.covariance = fromMessage(message.covariance);
  state.sigma_yaw_rad = message.sigma_yaw;
  state.measurement_applied = message.measurement_applied != 0;
  state.started = message.started != 0;
  take(message.motion_status, state.motion_status);
  state.T_previous_now = *increment;
  state.increment_covariance = fromMessage(message.increment_covariance);
  state.motion_covariance = fromMessage(message.motion_covariance);
  state.registration_covariance = fromMessage(message.registration_covariance);
  state.registered = message.registered;
  state.doubt = {message.doubt, message.doubt_yaw};
  state.speed_error.variance_m2_s2 = message.speed_variance;
  state.speed_error.kept = message.speed_kept;
  state.clock_jump = message.clock_jump != 0;
  state.set_back_s = setBack_s(message);
  state.view_range_m = finiteOr0(message.view_range);
  state.odom_reset_count = message.odom_reset_count;
  take(message.map_update, state.map_update);
  state.filter_nis = message.fused_nis;
  state.fusion.has_measurement = message.has_measurement != 0;
  state.fusion.z = Eigen::Map<const Vector6d>(message.fused_state.data());
  state.fusion.R = fromMessage(message.fused_covariance);
  state.fusion.weights = message.measurement_weights;
  state.fusion.nis = message.measurement_nis;
  state.fusion.all_gated_out = message.all_gated_out != 0;
  state.fusion.prediction_overruled = message.prediction_overruled != 0;
  state.fusion.prediction_invalid = message.prediction_invalid != 0;
  state.fusion.disagreement_m = message.disagreement;
  state.fusion.disagreement_yaw_rad = message.disagreement_yaw;
  state.fusion.confirmed = message.confirmed != 0;
  state.fusion.valid_inputs = static_cast<int>(message.valid_inputs);
  state.fusion.invalid_inputs = static_cast<int>(message.invalid_inputs);
  return state;
}

}  // namespace fail_aware
