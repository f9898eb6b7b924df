#include "bridge/graph_message_conversion.hpp"
#include "bridge/monitor_message_conversion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace fail_aware::graph_message_conversion_test {
namespace {

Pose somePose(double x) { return poseFromVector((Vector6d() << x, -2.0, 0.5, 0.02, -0.03, 2.5).finished()); }

Matrix6d someCovariance() {
  Matrix6d A;
  for (int i = 0; i < 36; ++i) A(i / 6, i % 6) = std::sin(i + 1.0);
  return A * A.transpose();
}

std_msgs::Header someHeader() {
  std_msgs::Header header;
  header.stamp = ros::Time(1317384506, 434103000);
  header.frame_id = "odom";
  return header;
}

TEST(GraphMessages, ReasonBitsAndStatesAreTheCores) {
  using Message = messages::TimeToFailure;
  EXPECT_EQ(Message::REASON_STALE, kReasonStale);
  EXPECT_EQ(Message::REASON_NO_MEASUREMENT, kReasonNoMeasurement);
  EXPECT_EQ(Message::REASON_PREDICTION_ONLY, kReasonPredictionOnly);
  EXPECT_EQ(Message::REASON_PREDICTION_OVERRULED, kReasonPredictionOverruled);
  EXPECT_EQ(Message::REASON_MEASUREMENTS_DISAGREE, kReasonMeasurementsDisagree);
  EXPECT_EQ(Message::REASON_WEAK_DIRECTION, kReasonWeakDirection);
  EXPECT_EQ(Message::REASON_SWEEP_INCOMPLETE, kReasonSweepIncomplete);
  EXPECT_EQ(Message::REASON_SWEEP_EMPTY, kReasonSweepEmpty);
  EXPECT_EQ(Message::REASON_MISSING_ICP_POINT, kReasonMissingIcpPoint);
  EXPECT_EQ(Message::REASON_MISSING_ICP_PLANE, kReasonMissingIcpPlane);
  EXPECT_EQ(Message::REASON_MISSING_CORNERS, kReasonMissingCorners);
  EXPECT_EQ(Message::REASON_ETA_THRESHOLD, kReasonEtaThreshold);
  EXPECT_EQ(Message::REASON_COVARIANCE_LIMIT, kReasonCovarianceLimit);
  EXPECT_EQ(Message::REASON_FROZEN_CLOUD, kReasonFrozenCloud);
  EXPECT_EQ(Message::REASON_TIME_JUMP, kReasonTimeJump);
  EXPECT_EQ(Message::REASON_DROPPED_SWEEPS, kReasonDroppedSweeps);
  EXPECT_EQ(Message::REASON_LOW_VISIBILITY, kReasonLowVisibility);
  EXPECT_EQ(Message::REASON_NO_ANSWER, kReasonNoAnswer);
  EXPECT_EQ(Message::REASON_MOTION_UNKNOWN, kReasonMotionUnknown);
  EXPECT_EQ(Message::REASON_TIME_FIELD_REFUSED, kReasonTimeFieldRefused);
  EXPECT_EQ(Message::REASON_WEAK_ROAD_AHEAD, kReasonWeakRoadAhead);
  EXPECT_EQ(Message::REASON_POINT_TIMES_CONTRADICTED, kReasonPointTimesContradicted);
  EXPECT_EQ(reasonText(Message::REASON_POINT_TIMES_CONTRADICTED << 1).rfind("BIT_", 0),
            0u);  // no bit without a constant
  EXPECT_EQ(Message::UNKNOWN, static_cast<int>(FailAwareState::kUnknown));
  EXPECT_EQ(Message::OK, static_cast<int>(FailAwareState::kOk));
  EXPECT_EQ(Message::DEGRADED, static_cast<int>(FailAwareState::kDegraded));
  EXPECT_EQ(Message::FAILING, static_cast<int>(FailAwareState::kFailing));
  EXPECT_EQ(Message::FAILED, static_cast<int>(FailAwareState::kFailed));
}

TEST(GraphMessages, PredictionThereAndBack) {
  SweepTask task;
  task.prediction.dt_s = 0.1;
  task.prediction.T_odom_cog_previous = somePose(1.0);
  task.prediction.T_odom_cog = somePose(2.0);
  task.prediction.covariance = someCovariance();
  task.prediction.sigma_yaw_rad = 0.01;
  task.prediction.motion_status = MotionStatus::kObserved;
  task.prediction.set_back_s = 0.3;
  task.prediction.stamp_error_s = -0.004;
  task.prediction.period_s = 0.1033;
  task.T_cog_lidar = somePose(-0.5);
  const ros::Time previous(1317384506, 330000000);
  const messages::SweepPrediction message = toMessage(task, someHeader(), previous);
  EXPECT_EQ(message.header.stamp, someHeader().stamp);
  EXPECT_EQ(message.previous_stamp, previous);
  const std::optional<SweepTask> back = fromMessage(message);
  ASSERT_TRUE(back);
  EXPECT_DOUBLE_EQ(back->prediction.stamp_s, someHeader().stamp.toSec());
  EXPECT_DOUBLE_EQ(back->prediction.dt_s, 0.1);
  EXPECT_TRUE(back->prediction.T_odom_cog_previous.isApprox(somePose(1.0), 1e-14));
  EXPECT_TRUE(back->prediction.T_odom_cog.isApprox(somePose(2.0), 1e-14));
  EXPECT_TRUE(back->T_cog_lidar.isApprox(somePose(-0.5), 1e-14));
  EXPECT_EQ(back->prediction.covariance, someCovariance());
  EXPECT_TRUE(back->prediction.motionKnown());
  EXPECT_EQ(back->prediction.set_back_s, 0.3);
  EXPECT_EQ(back->prediction.stamp_error_s, -0.004);
  EXPECT_EQ(back->prediction.period_s, 0.1033);
  task.prediction.dt_s = 0.0;
  EXPECT_TRUE(toMessage(task, someHeader(), previous).previous_stamp.isZero());
}

TEST(GraphMessages, PredictionBeyondAllPlacesIsNone) {
  SweepTask task;
  task.T_cog_lidar = somePose(-0.5);
  messages::SweepPrediction message = toMessage(task, someHeader(), ros::Time());
  EXPECT_TRUE(fromMessage(message));
  message.lidar_in_cog.position.x = -1e300;  // the square of a way to there is not finite
  EXPECT_FALSE(fromMessage(message));
}

TEST(GraphMessages, MeasurementThereAndBack) {
  Measurement measurement;
  measurement.status = MeasurementStatus::kTooFewCorners;
  measurement.T_odom_cog = somePose(3.0);
  measurement.covariance = someCovariance();
  measurement.rms_residual_m = 0.04;
  measurement.inlier_ratio = 0.7;
  measurement.inliers = 123;
  measurement.iterations = 9;
  measurement.seed_spread_m = 0.02;
  measurement.degenerate_directions = 2;
  measurement.min_information_ratio = 0.3;
  measurement.ahead = {0.002, 60.0};
  measurement.clock_jump_suspected = true;
  const Measurement back = fromMessage(toMessage(measurement, "x", someHeader()));
  EXPECT_EQ(back.status, measurement.status);
  EXPECT_TRUE(back.clock_jump_suspected);
  EXPECT_TRUE(back.T_odom_cog.isApprox(measurement.T_odom_cog, 1e-14));
  EXPECT_EQ(back.covariance, measurement.covariance);
  EXPECT_EQ(back.rms_residual_m, 0.04);
  EXPECT_EQ(back.inlier_ratio, 0.7);
  EXPECT_EQ(back.inliers, 123u);
  EXPECT_EQ(back.iterations, 9);
  EXPECT_EQ(back.seed_spread_m, 0.02);
  EXPECT_EQ(back.degenerate_directions, 2);
  EXPECT_EQ(back.min_information_ratio, 0.3);
  EXPECT_EQ(back.ahead.ratio, 0.002);
  EXPECT_EQ(back.ahead.distance_m, 60.0);
}

TEST(GraphMessages, MeasurementThatIsNoPoseIsNotFinite) {
  messages::PoseMeasurement message;  // a quaternion of zeros
  EXPECT_FALSE(isFinite(fromMessage(message).T_odom_cog));
  message.pose.orientation.w = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(isFinite(fromMessage(message).T_odom_cog));
  message.status = 77;
  EXPECT_FALSE(fromMessage(message).ok());
}

TEST(GraphMessages, WhatAMeasurementSaysOfItselfIsFinite) {
  messages::PoseMeasurement message;
  message.rms_residual = message.inlier_ratio = std::numeric_limits<double>::quiet_NaN();
  message.seed_spread = message.min_information_ratio = std::numeric_limits<double>::infinity();
  const Measurement measurement = fromMessage(message);
  for (const double value : {measurement.rms_residual_m, measurement.inlier_ratio, measurement.seed_spread_m,
                             measurement.min_information_ratio}) {
    EXPECT_EQ(value, 0.0);
  }
}

FilterState someState() {
  FilterState state;
  state.dt_s = 0.1;
  state.T_odom_cog = somePose(4.0);
  state.covariance = someCovariance();
  state.sigma_yaw_rad = 0.003;
  state.measurement_applied = true;
  state.map_update = MapUpdate::kRestart;
  state.T_previous_now = somePose(1.2);
  state.increment_covariance = 0.1 * someCovariance();
  state.motion_covariance = 0.01 * someCovariance();
  state.registration_covariance = 0.02 * someCovariance();
  state.registered = true;
  state.doubt = {0.3, 0.04};
  state.speed_error = {2.5, 0.75};
  state.clock_jump = true;
  state.set_back_s = 0.3;
  state.view_range_m = 12.0;
  state.stamp_error_s = 0.007;
  state.started = false;
  state.motion_status = MotionStatus::kObserved;
  state.filter_nis = 5.5;
  state.fusion.has_measurement = true;
  state.fusion.z = vectorFromPose(somePose(4.1));
  state.fusion.R = 2.0 * someCovariance();
  state.fusion.weights = {0.8, 0.7};
  state.fusion.nis = {3.0, 4.0};
  state.fusion.prediction_overruled = true;
  state.fusion.disagreement_m = 0.2;
  state.fusion.confirmed = true;
  state.fusion.valid_inputs = 2;
  return state;
}

TEST(GraphMessages, StateThereAndBack) {
  const FilterState state = someState();
  const std::optional<FilterState> back = fromMessage(toMessage(state, SweepAccount{}, someHeader()));
  ASSERT_TRUE(back);
  EXPECT_DOUBLE_EQ(back->stamp_s, someHeader().stamp.toSec());
  EXPECT_EQ(back->dt_s, state.dt_s);
  EXPECT_TRUE(back->T_odom_cog.isApprox(state.T_odom_cog, 1e-14));
  EXPECT_EQ(back->covariance, state.covariance);
  EXPECT_EQ(back->sigma_yaw_rad, state.sigma_yaw_rad);
  EXPECT_TRUE(back->measurement_applied);
  EXPECT_EQ(back->map_update, MapUpdate::kRestart);
  EXPECT_TRUE(back->T_previous_now.isApprox(state.T_previous_now, 1e-14));
  EXPECT_EQ(back->increment_covariance, state.increment_covariance);
  EXPECT_EQ(back->motion_covariance, state.motion_covariance);
  EXPECT_EQ(back->registration_covariance, state.registration_covariance);
  EXPECT_TRUE(back->registered);
  EXPECT_EQ(back->doubt.sigma_m, state.doubt.sigma_m);
  EXPECT_EQ(back->doubt.sigma_yaw_rad, state.doubt.sigma_yaw_rad);
  EXPECT_EQ(back->speed_error.variance_m2_s2, 2.5);
  EXPECT_EQ(back->speed_error.kept, 0.75);
  EXPECT_TRUE(back->clock_jump);
  EXPECT_EQ(back->set_back_s, 0.3);
  EXPECT_EQ(back->view_range_m, 12.0);
  EXPECT_EQ(back->stamp_error_s, 0.007);
  EXPECT_FALSE(back->started);
  EXPECT_EQ(back->motion_status, MotionStatus::kObserved);
  EXPECT_EQ(back->filter_nis, state.filter_nis);
  EXPECT_EQ(back->fusion.z, state.fusion.z);
  EXPECT_EQ(back->fusion.R, state.fusion.R);
  EXPECT_TRUE(back->fusion.has_measurement);
  EXPECT_TRUE(back->fusion.prediction_overruled);
  EXPECT_FALSE(back->fusion.all_gated_out);
  EXPECT_EQ(back->fusion.disagreement_m, 0.2);
  EXPECT_TRUE(back->fusion.confirmed);
  EXPECT_EQ(back->fusion.valid_inputs, 2);
}

TEST(GraphMessages, ConditionTellsWhatIsMissing) {
  Measurement ok;
  ok.status = MeasurementStatus::kOk;
  ok.min_information_ratio = 0.25;
  ok.ahead = {0.003, 50.0};
  SweepAccount account;
  account.sources = {{kIcpPointToPoint, Measurement()}, {kIcpPointToPlane, ok}, {kCornerSvd, std::nullopt}};
  account.sweep_points = 0;
  account.dropped_before = 2;
  const messages::FilterState message = toMessage(someState(), account, someHeader());
  EXPECT_TRUE(message.deadline_missed);
  EXPECT_EQ(message.measurement_status.at(2), messages::FilterState::NOT_ARRIVED);
  EXPECT_EQ(message.measurement_weights.size(), 3u);
  SweepCondition condition = conditionOf(message);
  EXPECT_TRUE(condition.no_answer);
  EXPECT_TRUE(condition.empty);
  EXPECT_EQ(condition.dropped_before, 2);
  EXPECT_TRUE(condition.point_missing);
  EXPECT_FALSE(condition.plane_missing);
  EXPECT_TRUE(condition.corners_missing);
  EXPECT_EQ(condition.min_information_ratio, 0.25);
  EXPECT_EQ(condition.ahead.ratio, 0.003);
  EXPECT_EQ(condition.ahead.distance_m, 50.0);
  EXPECT_FALSE(aheadOf(std::nan(""), 50.0).known());
  EXPECT_FALSE(aheadOf(0.003, -1.0).known());
  account.sweep_points = -1;
  EXPECT_FALSE(conditionOf(toMessage(someState(), account, someHeader())).empty);
  account.sources.pop_back();
  EXPECT_FALSE(conditionOf(toMessage(someState(), account, someHeader())).corners_missing) << "not used, not missed";
}

TEST(GraphMessages, ConditionTellsWhatTheSweepsCheckFound) {
  SweepAccount account;
  EXPECT_TRUE(conditionOf(toMessage(someState(), account, someHeader())).no_answer) << "not even the check came";
  SweepFindings findings;
  findings.incomplete = findings.frozen = true;
  findings.repetitions = 4;
  findings.middle_s = -0.05;
  findings.view_range_m = 42.0;
  findings.azimuth_coverage = 0.5;
  const messages::SweepCheck check = toMessage(findings, 77, someHeader());
  EXPECT_EQ(check.points, 77);
  account.findings = fromMessage(check);
  EXPECT_EQ(account.findings->repetitions, 4);
  EXPECT_EQ(account.findings->middle_s, -0.05);
  EXPECT_EQ(account.findings->view_range_m, 42.0);
  EXPECT_EQ(account.findings->azimuth_coverage, 0.5);
  account.sources = {{"gps", std::nullopt, false}};
  SweepCondition condition = conditionOf(toMessage(someState(), account, someHeader()));
  EXPECT_FALSE(condition.no_answer) << "nobody waits for it";
  EXPECT_TRUE(condition.incomplete && condition.frozen);
  EXPECT_FALSE(condition.low_visibility || condition.time_jump || condition.time_field_refused);
  EXPECT_FALSE(condition.point_times_contradicted);
  account.findings->incomplete = account.findings->frozen = false;
  account.findings->low_visibility = account.findings->time_jump = true;
  findings.time_field_refused = true;
  EXPECT_TRUE(fromMessage(toMessage(findings, 77, someHeader())).time_field_refused);
  EXPECT_FALSE(fromMessage(toMessage(findings, 77, someHeader())).point_times_contradicted);
  findings.point_times_contradicted = true;
  EXPECT_TRUE(fromMessage(toMessage(findings, 77, someHeader())).point_times_contradicted);
  account.findings->time_field_refused = account.findings->point_times_contradicted = true;
  condition = conditionOf(toMessage(someState(), account, someHeader()));
  EXPECT_FALSE(condition.incomplete || condition.frozen);
  EXPECT_TRUE(condition.low_visibility && condition.time_jump && condition.time_field_refused);
  EXPECT_TRUE(condition.point_times_contradicted);
}

TEST(GraphMessages, TimesToFailureAreNeverMistaken) {
  MonitorOutput output;
  const MonitorParameters params;
  messages::TimeToFailure message = toMessage(output, params, someHeader());
  EXPECT_TRUE(message.t1.isZero());
  EXPECT_EQ(message.time_to_failure, -1.0);
  EXPECT_EQ(message.protection_level, -1.0);
  EXPECT_EQ(message.state, messages::TimeToFailure::UNKNOWN);
  output.time_to_failure = TimeToFailure::fromSeconds(std::numeric_limits<double>::infinity(), 60.0);
  output.reasons = kReasonStale;
  output.t1_stamp_s = 12.5;
  output.protection_level_m = 0.75;
  message = toMessage(output, params, someHeader());
  EXPECT_EQ(message.time_to_failure, message.horizon);
  EXPECT_EQ(message.reasons_text, "STALE");
  EXPECT_EQ(message.t1.toSec(), 12.5);
  EXPECT_EQ(message.protection_level, 0.75);
  EXPECT_EQ(message.eta_threshold, params.indicator.threshold);
  EXPECT_EQ(message.alert_limit, params.predictor.alert_limit_m);
}

}  // namespace
}  // namespace fail_aware::graph_message_conversion_test
