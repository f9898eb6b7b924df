#include "core/integrity/monitor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "../../support/independent_drift.hpp"
#include "../parameters/error_of.hpp"
#include "core/geometry/rotation.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::monitor_test {
namespace {

constexpr double kDt_s = 0.1;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

/// A straight drive at 10 m/s along the heading, 1 cm and 0.01 deg of independent error a sweep.
class Road {
 public:
  explicit Road(double yaw_rad = 0.0) { T_odom_cog_.linear() = rotationFromRpy(0.0, 0.0, yaw_rad); }

  FilterState next() {
    FilterState state;
    state.stamp_s = 50.0 + kDt_s * sweep_;
    if (sweep_++ > 0) {
      state.dt_s = kDt_s;
      state.T_previous_now.translation().x() = speed_mps * kDt_s;
      state.motion_covariance = 1e4 * (1.0 + sigma_m * sigma_m) * Matrix6d::Identity();  // all is known by registration
      state.registration_covariance.diagonal() << sigma_m * sigma_m, sigma_m * sigma_m, 0.0, 0.0, 0.0,
          sigma_yaw_step_rad * sigma_yaw_step_rad;
      state.registered = true;
      state.map_update = MapUpdate::kInsert;
      state.measurement_applied = true;
      state.fusion.valid_inputs = 3;
      state.fusion.confirmed = true;
    }
    T_odom_cog_ = T_odom_cog_ * state.T_previous_now;
    state.T_odom_cog = T_odom_cog_;
    state.sigma_yaw_rad = 1e-3;
    state.motion_status = MotionStatus::kObserved;
    return state;
  }

  double speed_mps = 10.0;
  double sigma_m = 0.01;
  double sigma_yaw_step_rad = 1.75e-4;

 private:
  Pose T_odom_cog_ = Pose::Identity();
  int sweep_ = 0;
};

/// The closed forms below are those of sweeps whose errors know nothing of each other, one confidence for both times
/// and the article's threshold.
MonitorParameters independentSweeps() {
  MonitorParameters params;
  params.drift = independentDrift();
  params.predictor.confidence = params.predictor.alarm_confidence = 0.95;
  params.predictor.degrees_of_freedom = 0.0;
  params.indicator.threshold = 0.001;
  params.indicator.average_s = params.indicator.reference_speed_mps = 0.0;
  return params;
}

MonitorOutput drive(FailAwareMonitor& monitor, Road& road, int sweeps, const SweepCondition& condition = {}) {
  MonitorOutput output;
  for (int i = 0; i < sweeps; ++i) output = monitor.update(road.next(), condition);
  return output;
}

void expectFinite(const MonitorOutput& output) {
  for (const double value : {output.stamp_s, output.time_to_failure.seconds, output.time_to_failure_indicator.seconds,
                             output.time_to_failure_covariance.seconds, output.eta, output.eta_rate_per_s,
                             output.sigma_yaw_rad, output.sigma_x_m, output.sigma_y_m}) {
    EXPECT_TRUE(std::isfinite(value)) << value;
  }
}

TEST(FailAwareMonitor, BeforeTheStartTimesAreUnknown) {
  FailAwareMonitor monitor{independentSweeps()};
  Road road;
  EXPECT_FALSE(monitor.started());
  for (int i = 0; i < 30; ++i) {
    const MonitorOutput output = monitor.update(road.next(), {});
    EXPECT_EQ(output.state, FailAwareState::kUnknown);
    EXPECT_FALSE(output.time_to_failure.isKnown());
    EXPECT_FALSE(output.time_to_failure_indicator.isKnown());
    EXPECT_FALSE(output.time_to_failure_covariance.isKnown());
    EXPECT_EQ(output.time_to_failure.seconds, -1.0);
    EXPECT_EQ(output.eta, 0.0);
    EXPECT_EQ(output.eta_rate_per_s, -1.0);
    EXPECT_EQ(output.sigma_x_m, 0.0);
    EXPECT_NEAR(output.stamp_s, 50.0 + kDt_s * i, 1e-9);
  }
}

TEST(FailAwareMonitor, StartMakesTheNextUpdateT1) {
  FailAwareMonitor monitor{independentSweeps()};
  Road road;
  EXPECT_EQ(drive(monitor, road, 40).t1_stamp_s, -1.0);
  monitor.start();
  EXPECT_TRUE(monitor.started());
  const MonitorOutput at_start = drive(monitor, road, 1);
  EXPECT_EQ(at_start.t1_stamp_s, at_start.stamp_s);
  EXPECT_EQ(at_start.sigma_x_m, 0.0) << "what came before t1 does not count";
  EXPECT_EQ(at_start.sigma_y_m, 0.0);
  EXPECT_TRUE(at_start.time_to_failure_covariance.isKnown()) << "the rate was known before";
  EXPECT_FALSE(at_start.time_to_failure_indicator.isKnown());
  EXPECT_EQ(at_start.time_to_failure.seconds, at_start.time_to_failure_covariance.seconds);

  const MonitorOutput later = drive(monitor, road, 30);
  EXPECT_EQ(later.t1_stamp_s, at_start.stamp_s);
  EXPECT_TRUE(later.time_to_failure_indicator.isKnown());
  EXPECT_NEAR(later.sigma_x_m, 0.01 * std::sqrt(30.0), 1e-6);

  monitor.start();  // anew
  EXPECT_EQ(drive(monitor, road, 1).sigma_x_m, 0.0);
}

TEST(FailAwareMonitor, LostStatesLeaveTheErrorWithoutABound) {
  FailAwareMonitor monitor{independentSweeps()};
  Road road;
  monitor.start();
  drive(monitor, road, 40);
  road.next();
  const MonitorOutput output = drive(monitor, road, 1);
  EXPECT_EQ(output.state, FailAwareState::kFailed);
  EXPECT_EQ(output.reasons & kReasonDroppedSweeps, std::uint32_t{kReasonDroppedSweeps});
  EXPECT_EQ(drive(monitor, road, 40).state, FailAwareState::kFailed) << "no later sweep tells what was lost";
  monitor.start();
  EXPECT_NE(drive(monitor, road, 20).state, FailAwareState::kFailed);
}

TEST(FailAwareMonitor, AClockJumpIsNoSpeed) {
  FailAwareMonitor monitor{independentSweeps()}, without{independentSweeps()};
  Road road;
  drive(monitor, road, 40);
  without = monitor;
  road.speed_mps = 80.0;  // 8 m over what the stamps call 0.1 s
  FilterState jump = road.next();
  jump.clock_jump = true;
  const MonitorOutput output = monitor.update(jump, {});
  jump.clock_jump = false;
  EXPECT_GT(output.standby_time_to_failure.seconds, without.update(jump, {}).standby_time_to_failure.seconds);
}

TEST(FailAwareMonitor, T1WaitsUntilTheMotionIsObserved) {
  FailAwareMonitor monitor(independentSweeps());
  Road road;
  monitor.start();
  for (int i = 0; i < 5; ++i) {
    FilterState state = road.next();
    state.motion_status = MotionStatus::kDeadReckoning;
    state.registration_covariance *= 1e4;  // the speed is not known
    const MonitorOutput output = monitor.update(state, {});
    EXPECT_TRUE(monitor.startPending());
    EXPECT_EQ(output.state, FailAwareState::kUnknown) << i;
    EXPECT_EQ(output.reasons, std::uint32_t{kReasonMotionUnknown}) << i;
    EXPECT_EQ(output.t1_stamp_s, -1.0);
  }
  const FilterState state = road.next();
  const MonitorOutput output = monitor.update(state, {});
  EXPECT_FALSE(monitor.startPending());
  EXPECT_EQ(output.t1_stamp_s, state.stamp_s);
  EXPECT_EQ(output.reasons, 0u);
  EXPECT_EQ(output.state, FailAwareState::kOk);
  EXPECT_LT(drive(monitor, road, 1).sigma_x_m, 2.0 * road.sigma_m) << "what was before t1 does not count";
}

/// A sweep that nothing measures.
FilterState blindedSweep(Road& road) {
  FilterState state = road.next();
  state.motion_covariance.setZero();
  state.motion_covariance.diagonal().head<2>().setConstant(0.01);
  state.registered = state.measurement_applied = state.fusion.confirmed = false;
  state.motion_status = MotionStatus::kDeadReckoning;
  return state;
}

TEST(FailAwareMonitor, RequestWhileBlindCountsWhatFollows) {
  FailAwareMonitor monitor{independentSweeps()};
  Road road;
  drive(monitor, road, 40);
  monitor.update(blindedSweep(road), {});
  monitor.start();
  FilterState state = blindedSweep(road);
  MonitorOutput output = monitor.update(state, {});
  EXPECT_EQ(output.t1_stamp_s, state.stamp_s) << "the request's, not that of the first measurement";
  EXPECT_NEAR(output.sigma_x_m, 0.1, 0.03) << "this step's error counts";
  for (int i = 0; i < 100; ++i) output = monitor.update(blindedSweep(road), {});
  EXPECT_EQ(output.state, FailAwareState::kFailed);
  EXPECT_GT(output.sigma_x_m, 0.9);
  EXPECT_GT(drive(monitor, road, 40).sigma_x_m, 0.9) << "no measurement tells what was lost";
}

TEST(FailAwareMonitor, WithoutAKnownGrowthEtaPromisesNothing) {
  FailAwareMonitor monitor{independentSweeps()};
  Road road;
  const auto tunnel = [&] {  // measured, but not along the road; no motion was ever observed
    FilterState state = blindedSweep(road);
    state.measurement_applied = true;
    return state;
  };
  for (int i = 0; i < 5; ++i) monitor.update(tunnel(), {});
  monitor.start();
  MonitorOutput output;
  for (int i = 0; i < 100; ++i) {
    output = monitor.update(tunnel(), {});
    ASSERT_EQ(output.state, FailAwareState::kUnknown) << i;
    ASSERT_FALSE(output.time_to_failure.isKnown()) << i;
    ASSERT_TRUE(output.reasons & kReasonMotionUnknown) << i;
  }
  EXPECT_GE(output.t1_stamp_s, 0.0) << "it serves";
  EXPECT_TRUE(output.time_to_failure_indicator.isKnown());
  EXPECT_TRUE(drive(monitor, road, 2).time_to_failure.isKnown()) << "observed";
}

TEST(FailAwareMonitor, RequestInAGapCountsTheGap) {
  FailAwareMonitor monitor{independentSweeps()};
  Road road;
  drive(monitor, road, 40);
  monitor.start();
  FilterState state = road.next();
  state.dt_s = 5.0;
  state.registered = false;
  state.motion_covariance = 4.0 * Matrix6d::Identity();
  EXPECT_NEAR(monitor.update(state, {}).sigma_x_m, 2.0, 0.1);
}

TEST(FailAwareMonitor, APoseSetWhileBlindIsT1AtOnce) {
  FailAwareMonitor monitor{independentSweeps()};
  Road road;
  monitor.start();
  drive(monitor, road, 40);
  for (int i = 0; i < 20; ++i) monitor.update(blindedSweep(road), {});
  FilterState state = blindedSweep(road);
  state.odom_reset_count = 1;
  EXPECT_EQ(monitor.update(state, {}).t1_stamp_s, state.stamp_s);
  for (int i = 0; i < 100; ++i) {
    state = blindedSweep(road);
    state.odom_reset_count = 1;
    monitor.update(state, {});
  }
  state = road.next();
  state.odom_reset_count = 1;
  EXPECT_GT(monitor.update(state, {}).sigma_x_m, 0.9) << "what was blind since then counts";
}

TEST(FailAwareMonitor, AFilterThatBeganAnewLostStates) {
  FailAwareMonitor monitor{independentSweeps()};
  Road road;
  monitor.start();
  FilterState state;
  for (int i = 0; i < 40; ++i) {
    state = road.next();
    state.odom_reset_count = 1;
    monitor.update(state, {});
  }
  const MonitorOutput output = drive(monitor, road, 1);
  EXPECT_EQ(output.state, FailAwareState::kFailed);
  EXPECT_NE(output.reasons & kReasonDroppedSweeps, 0u);
  EXPECT_NE(output.t1_stamp_s, state.stamp_s + kDt_s);
}

TEST(FailAwareMonitor, OneUnmeasuredSweepCostsNoStop) {
  FailAwareMonitor monitor{independentSweeps()};
  Road road;
  road.sigma_m = 0.001;
  road.sigma_yaw_step_rad = 1e-5;
  monitor.start();
  const MonitorOutput before = drive(monitor, road, 60);
  MonitorOutput output = monitor.update(blindedSweep(road), {});
  EXPECT_EQ(output.state, FailAwareState::kDegraded) << "PREDICTION_ONLY";
  output = drive(monitor, road, 60);
  EXPECT_EQ(output.state, FailAwareState::kOk);
  EXPECT_NEAR(output.time_to_failure_covariance.seconds, before.time_to_failure_covariance.seconds, 10.0);
  for (int i = 0; i < 5; ++i) output = monitor.update(blindedSweep(road), {});
  EXPECT_GE(output.state, FailAwareState::kFailing) << "0.5 s";
}

TEST(FailAwareMonitor, AHeadingThatComesBackIsNotTheFuture) {
  FailAwareMonitor monitor{MonitorParameters()};
  Road road;
  road.sigma_m = 0.001;
  road.sigma_yaw_step_rad = 1e-5;
  monitor.start();
  drive(monitor, road, 60);
  FilterState turned = blindedSweep(road);
  turned.motion_covariance(5, 5) = 1e-4;  // a heading that stays so is 0.6 m off in 6 s
  EXPECT_EQ(monitor.update(turned, {}).state, FailAwareState::kDegraded);
  EXPECT_EQ(drive(monitor, road, 60).state, FailAwareState::kOk);
}

TEST(FailAwareMonitor, StandbySaysWhatServingFromNowOnWouldGive) {
  FailAwareMonitor standby(independentSweeps()), serving(independentSweeps());
  Road road;
  drive(standby, road, 20);
  FilterState state = road.next();
  const MonitorOutput ready = standby.update(state, {});
  EXPECT_EQ(ready.state, FailAwareState::kUnknown);
  EXPECT_EQ(ready.standby_state, FailAwareState::kOk);

  Road same;
  drive(serving, same, 20);
  serving.start();
  const MonitorOutput served = serving.update(state, {});
  EXPECT_EQ(served.state, FailAwareState::kOk);
  EXPECT_EQ(ready.standby_time_to_failure.seconds, served.time_to_failure_covariance.seconds);
  EXPECT_EQ(served.standby_state, FailAwareState::kUnknown) << "it serves";
  EXPECT_FALSE(served.standby_time_to_failure.isKnown());

  state = road.next();
  state.motion_status = MotionStatus::kDeadReckoning;
  const MonitorOutput blind = standby.update(state, {});
  EXPECT_EQ(blind.standby_state, FailAwareState::kUnknown);
  EXPECT_FALSE(blind.standby_time_to_failure.isKnown());
}

TEST(FailAwareMonitor, ASecondStartLeavesNothingOfTheFirst) {
  FailAwareMonitor monitor(independentSweeps());
  Road road;
  drive(monitor, road, 20);
  monitor.start();
  drive(monitor, road, 20);
  FilterState lost = road.next();
  lost.registration_covariance *= 1e6;
  ASSERT_EQ(monitor.update(lost, {}).state, FailAwareState::kFailed);

  monitor.start();
  EXPECT_TRUE(monitor.startPending());
  EXPECT_TRUE(monitor.horizontalCovarianceOdom().isZero());
  const MonitorOutput served = drive(monitor, road, 1);
  EXPECT_LT(served.protection_level_m, 0.6);
  EXPECT_NE(served.state, FailAwareState::kUnknown);
  EXPECT_EQ(served.t1_stamp_s, served.stamp_s);
}

TEST(FailAwareMonitor, WhatTakesBackAPredictionIsNoSpeed) {
  FailAwareMonitor monitor(independentSweeps());
  Road road;
  monitor.start();
  const double before_s = drive(monitor, road, 20).time_to_failure.seconds;
  FilterState blind = road.next();
  blind.measurement_applied = false;
  monitor.update(blind, {});
  FilterState corrected = road.next();
  corrected.T_previous_now.translation().x() += 8.0;  // 80 m/s more
  corrected.T_odom_cog.translation().x() += 8.0;
  EXPECT_NEAR(monitor.update(corrected, {}).time_to_failure.seconds, before_s, 0.3 * before_s);
}

TEST(FailAwareMonitor, AnUnboundedErrorBeforeT1IsNoneOfStandby) {
  FailAwareMonitor monitor(independentSweeps());
  Road road;
  drive(monitor, road, 20);
  FilterState state = road.next();
  state.registration_covariance(0, 0) = std::numeric_limits<double>::quiet_NaN();
  monitor.update(state, {});
  EXPECT_EQ(drive(monitor, road, 20).standby_state, FailAwareState::kOk);
}

TEST(FailAwareMonitor, StoppedItIsOnStandby) {
  FailAwareMonitor monitor(independentSweeps());
  Road road;
  monitor.start();
  ASSERT_EQ(drive(monitor, road, 20).state, FailAwareState::kOk);
  monitor.stop();
  EXPECT_FALSE(monitor.started());
  const MonitorOutput output = drive(monitor, road, 1);
  EXPECT_EQ(output.state, FailAwareState::kUnknown);
  EXPECT_FALSE(output.time_to_failure.isKnown());
  EXPECT_EQ(output.standby_state, FailAwareState::kOk);
}

TEST(FailAwareMonitor, EarlyStartIsUnknownForOneSweep) {
  FailAwareMonitor monitor{independentSweeps()};
  Road road;
  monitor.start();
  EXPECT_EQ(drive(monitor, road, 1).state, FailAwareState::kUnknown);
  const MonitorOutput second = drive(monitor, road, 1);
  EXPECT_TRUE(second.time_to_failure_covariance.isKnown());
  EXPECT_EQ(second.state, FailAwareState::kOk);
}

TEST(FailAwareMonitor, CovarianceGrowsWithDistance) {
  for (const double yaw_rad : {0.0, 0.5 * M_PI, -2.5}) {
    FailAwareMonitor monitor{independentSweeps()};
    Road road(yaw_rad);
    monitor.start();
    drive(monitor, road, 1);
    double last_x_m = 0.0, last_y_m = 0.0;
    for (int k = 1; k <= 100; ++k) {
      const MonitorOutput output = drive(monitor, road, 1);
      EXPECT_GT(output.sigma_x_m, last_x_m);
      EXPECT_GT(output.sigma_y_m, last_y_m);
      last_x_m = output.sigma_x_m;
      last_y_m = output.sigma_y_m;
    }
    // k increments; the heading error of increment j leans on the k - j metres driven after it
    double lever_sum = 0.0;
    for (int j = 0; j < 100; ++j) lever_sum += static_cast<double>(j * j);
    EXPECT_NEAR(last_x_m, 0.01 * std::sqrt(100.0), 1e-6) << yaw_rad;
    EXPECT_NEAR(last_y_m, std::sqrt(100.0 * 1e-4 + 1.75e-4 * 1.75e-4 * lever_sum), 1e-5) << yaw_rad;
  }
}

TEST(FailAwareMonitor, TheHorizontalCovarianceIsAboutOdomsAxes) {
  FailAwareMonitor ahead{independentSweeps()}, aslant{independentSweeps()};
  Road straight(0.0), turned(0.5);
  straight.sigma_yaw_step_rad = turned.sigma_yaw_step_rad = 2e-3;  // mostly lateral
  EXPECT_TRUE(ahead.horizontalCovarianceOdom().isZero());
  ahead.start();
  aslant.start();
  drive(ahead, straight, 100);
  drive(aslant, turned, 100);
  const Eigen::Matrix2d R = Eigen::Rotation2Dd(0.5).toRotationMatrix();
  const Eigen::Matrix2d C = ahead.horizontalCovarianceOdom();
  EXPECT_GT(C(1, 1), 4.0 * C(0, 0));
  EXPECT_TRUE(aslant.horizontalCovarianceOdom().isApprox(R * C * R.transpose(), 1e-6));
}

TEST(FailAwareMonitor, TheCovariancesTimeToFailureRunsDown) {
  FailAwareMonitor monitor{independentSweeps()};
  Road road;
  road.sigma_m = 0.02;
  road.sigma_yaw_step_rad = 5e-4;
  monitor.start();
  const MonitorOutput early = drive(monitor, road, 10);
  ASSERT_EQ(early.time_to_failure_covariance.status, TimeToFailureStatus::kWithinHorizon);
  MonitorOutput output = early;
  int sweeps = 0;
  while (output.time_to_failure_covariance.status == TimeToFailureStatus::kWithinHorizon && sweeps < 600) {
    const double before_s = output.time_to_failure_covariance.seconds;
    output = drive(monitor, road, 1);
    EXPECT_LT(output.time_to_failure_covariance.seconds, before_s);
    ++sweeps;
  }
  EXPECT_EQ(output.time_to_failure_covariance.status, TimeToFailureStatus::kReached);
  EXPECT_NEAR(kDt_s * sweeps, early.time_to_failure_covariance.seconds, 0.3) << "a constant drive ends when foretold";
  EXPECT_EQ(output.state, FailAwareState::kFailed);
  EXPECT_NE(output.reasons & kReasonCovarianceLimit, 0u);
}

TEST(FailAwareMonitor, ASingleBlindedSweepIsNotTheFuture) {
  FailAwareMonitor monitor{MonitorParameters()};
  monitor.start();
  Road road;
  road.sigma_m = 0.001;
  road.sigma_yaw_step_rad = 1e-5;
  const double before_s = drive(monitor, road, 60).time_to_failure_covariance.seconds;
  const auto blinded = [&] {
    FilterState state = road.next();
    state.motion_covariance = 1e-8 * Matrix6d::Identity();
    state.registered = false;
    state.speed_error = {0.04, 0.99};
    return monitor.update(state, {}).time_to_failure_covariance.seconds;
  };
  EXPECT_GT(blinded(), 0.5 * before_s);
  EXPECT_GT(drive(monitor, road, 1).time_to_failure_covariance.seconds, 0.5 * before_s);
  for (int i = 0; i < 5; ++i) blinded();
  EXPECT_LT(blinded(), 0.5 * before_s);
}

TEST(FailAwareMonitor, WhatADriveBeginsWithIsNotTheFuture) {
  const auto timeAfterStart_s = [](bool blind) {
    FailAwareMonitor monitor{MonitorParameters()};
    Road road;
    road.sigma_m = 0.001;
    road.sigma_yaw_step_rad = 1e-5;
    for (int i = 0; i < 5; ++i) {
      FilterState state = road.next();
      state.motion_status = MotionStatus::kUnknown;
      if (blind) state.motion_covariance = 1e-4 * Matrix6d::Identity();
      if (blind) state.registered = false;
      monitor.update(state, {});
    }
    monitor.start();
    return drive(monitor, road, 1).time_to_failure_covariance.seconds;
  };
  EXPECT_EQ(timeAfterStart_s(true), timeAfterStart_s(false));
}

TEST(FailAwareMonitor, ACovarianceThatNothingCanBeToldOfIsAFailure) {
  FailAwareMonitor monitor(independentSweeps());
  monitor.start();
  Road road;
  EXPECT_EQ(drive(monitor, road, 40).state, FailAwareState::kOk);
  road.sigma_m = 1e7;  // beyond what the predictor takes
  const MonitorOutput output = drive(monitor, road, 40);
  EXPECT_EQ(output.protection_level_m, 1e6) << "the worst there is";
  EXPECT_EQ(output.state, FailAwareState::kFailed);
  EXPECT_EQ(output.time_to_failure.seconds, 0.0);
  EXPECT_NE(output.reasons & kReasonCovarianceLimit, 0u);
}

TEST(FailAwareMonitor, UnsteadyHeadingReachesEtaThreshold) {
  MonitorParameters params = independentSweeps();
  FailAwareMonitor monitor(params);
  Road road;
  monitor.start();
  MonitorOutput output;
  for (int i = 0; i < 60; ++i) {  // each sweep adds 4e-5 rad to eta
    FilterState state = road.next();
    state.sigma_yaw_rad = 1e-3 + (i % 2 == 0 ? 1e-5 : -1e-5);
    output = monitor.update(state, {});
    if (i == 12) {
      EXPECT_NEAR(output.eta, 11 * 4e-5, 1e-9);
      EXPECT_NEAR(output.eta_rate_per_s, 4e-4, 1e-9);
      EXPECT_NEAR(output.time_to_failure_indicator.seconds, (params.indicator.threshold - output.eta) / 4e-4, 1e-6);
      EXPECT_EQ(output.time_to_failure.seconds, output.time_to_failure_indicator.seconds) << "the earlier of the two";
      EXPECT_EQ(output.reasons & kReasonEtaThreshold, 0u);
    }
  }
  EXPECT_EQ(output.time_to_failure_indicator.status, TimeToFailureStatus::kReached);
  EXPECT_NE(output.reasons & kReasonEtaThreshold, 0u);
  EXPECT_EQ(output.reasons & kReasonCovarianceLimit, 0u);
  EXPECT_EQ(output.state, FailAwareState::kFailed);
}

TEST(FailAwareMonitor, ReachedTimesOrderByProtectionLevel) {
  MonitorOutput near, far;
  near.time_to_failure = far.time_to_failure = TimeToFailure::reached();
  near.protection_level_m = 0.7;
  far.protection_level_m = 2.0;
  const auto order = [](const MonitorOutput& output) { return failureOrder(output.time_to_failure, output); };
  EXPECT_GT(order(near), order(far));
  MonitorOutput later;
  EXPECT_FALSE(order(later)) << "unknown";
  later.time_to_failure = TimeToFailure::fromSeconds(0.5, 60.0);
  later.protection_level_m = 5.0;
  EXPECT_EQ(order(later), 0.5) << "a time that is not reached is the order, whatever the level";
  EXPECT_GT(order(later), order(near));
  near.protection_level_m = -1.0;
  EXPECT_EQ(order(near), 0.0) << "reached by eta, the level unknown";
}

TEST(FailAwareMonitor, EachConditionHasItsReason) {
  struct Case {
    const char* name;
    ReasonBit bit;
    bool in_first_sweep;  ///< where there is nothing to register against yet
    std::function<void(FilterState&, SweepCondition&)> cause;
  };
  const Case cases[] = {
      {"empty", kReasonSweepEmpty, true, [](FilterState&, SweepCondition& c) { c.empty = true; }},
      {"incomplete", kReasonSweepIncomplete, true, [](FilterState&, SweepCondition& c) { c.incomplete = true; }},
      {"fog", kReasonLowVisibility, true, [](FilterState&, SweepCondition& c) { c.low_visibility = true; }},
      {"time jump", kReasonTimeJump, true, [](FilterState&, SweepCondition& c) { c.time_jump = true; }},
      {"time field", kReasonTimeFieldRefused, true,
       [](FilterState&, SweepCondition& c) { c.time_field_refused = true; }},
      {"point times", kReasonPointTimesContradicted, true,
       [](FilterState&, SweepCondition& c) { c.point_times_contradicted = true; }},
      {"no answer", kReasonNoAnswer, true, [](FilterState&, SweepCondition& c) { c.no_answer = true; }},
      {"dropped", kReasonDroppedSweeps, true, [](FilterState&, SweepCondition& c) { c.dropped_before = 2; }},
      {"none", kReasonNoMeasurement, false, [](FilterState& s, SweepCondition&) { s.fusion.valid_inputs = 0; }},
      {"predicted", kReasonPredictionOnly, false,
       [](FilterState& s, SweepCondition&) { s.measurement_applied = false; }},
      {"overruled", kReasonPredictionOverruled, false,
       [](FilterState& s, SweepCondition&) { s.fusion.prediction_overruled = true; }},
      {"disagree", kReasonMeasurementsDisagree, false,
       [](FilterState& s, SweepCondition&) { s.fusion.disagreement_m = 0.31; }},
      {"weak", kReasonWeakDirection, false, [](FilterState&, SweepCondition& c) { c.min_information_ratio = 0.005; }},
      {"no point", kReasonMissingIcpPoint, false, [](FilterState&, SweepCondition& c) { c.point_missing = true; }},
      {"no plane", kReasonMissingIcpPlane, false, [](FilterState&, SweepCondition& c) { c.plane_missing = true; }},
      {"no corners", kReasonMissingCorners, false, [](FilterState&, SweepCondition& c) { c.corners_missing = true; }},
  };
  for (const Case& c : cases) {
    for (const bool first : {false, true}) {
      FailAwareMonitor monitor{independentSweeps()};
      Road road;
      monitor.start();
      if (!first) {
        EXPECT_EQ(drive(monitor, road, 30).reasons, 0u) << c.name;
      }
      FilterState state = road.next();
      SweepCondition condition;
      c.cause(state, condition);
      const MonitorOutput output = monitor.update(state, condition);
      EXPECT_EQ(output.reasons, first && !c.in_first_sweep ? 0u : static_cast<std::uint32_t>(c.bit)) << c.name << first;
      if (first) continue;
      EXPECT_EQ(output.state, c.bit == kReasonMissingCorners ? FailAwareState::kOk : FailAwareState::kDegraded)
          << c.name;
    }
  }
}

TEST(FailAwareMonitor, AtTheThresholdsThereIsNoReasonYet) {
  const MonitorParameters params = independentSweeps();
  FailAwareMonitor monitor(params);
  Road road;
  drive(monitor, road, 5);
  FilterState state = road.next();
  state.fusion.disagreement_m = params.disagreement_m;
  SweepCondition condition;
  condition.min_information_ratio = params.min_information_ratio;
  EXPECT_EQ(monitor.update(state, condition).reasons, 0u);
}

TEST(FailAwareMonitor, IncompleteSweepsDoNotLookAhead) {
  FailAwareMonitor monitor{independentSweeps()};
  Road road;
  SweepCondition walls_on_both_sides, wall_on_one_side;
  walls_on_both_sides.ahead = {0.1, 30.0};
  wall_on_one_side.ahead = {0.0005, 20.0};
  drive(monitor, road, 10, walls_on_both_sides);
  wall_on_one_side.incomplete = true;
  const MonitorOutput incomplete = drive(monitor, road, 10, wall_on_one_side);
  EXPECT_EQ(incomplete.reasons & kReasonWeakRoadAhead, 0u);
  EXPECT_EQ(incomplete.min_information_ahead, 1.0);
  wall_on_one_side.incomplete = false;
  EXPECT_NE(drive(monitor, road, 10, wall_on_one_side).reasons & kReasonWeakRoadAhead, 0u);
  wall_on_one_side.incomplete = true;
  EXPECT_EQ(drive(monitor, road, 10, wall_on_one_side).reasons & kReasonWeakRoadAhead, 0u) << "not for ever";
}

TEST(FailAwareMonitor, StateRecoversWithHysteresis) {
  MonitorParameters params = independentSweeps();
  params.sweeps_to_recover = 4;
  FailAwareMonitor monitor(params);
  Road road;
  monitor.start();
  EXPECT_EQ(drive(monitor, road, 30).state, FailAwareState::kOk);
  SweepCondition empty;
  empty.empty = true;
  EXPECT_EQ(drive(monitor, road, 1, empty).state, FailAwareState::kDegraded);
  EXPECT_EQ(drive(monitor, road, 3).state, FailAwareState::kDegraded);
  EXPECT_EQ(drive(monitor, road, 1, empty).state, FailAwareState::kDegraded);
  EXPECT_EQ(drive(monitor, road, 3).state, FailAwareState::kDegraded) << "counted from the last bad sweep";
  EXPECT_EQ(drive(monitor, road, 1).state, FailAwareState::kOk);
}

TEST(FailAwareMonitor, ATimeToFailureThatIsShortDegrades) {
  MonitorParameters params = independentSweeps();
  params.sweeps_to_recover = 1;
  FailAwareMonitor monitor(params);
  Road road;
  road.sigma_m = 0.02;
  road.sigma_yaw_step_rad = 5e-4;
  monitor.start();
  drive(monitor, road, 1);
  FailAwareState last = FailAwareState::kOk;
  bool seen[5] = {};
  for (int i = 0; i < 600 && last != FailAwareState::kFailed; ++i) {
    const MonitorOutput output = drive(monitor, road, 1);
    const double seconds = output.time_to_failure.seconds;
    const FailAwareState expected =
        seconds <= params.thresholds.failingWithin_s(road.speed_mps)    ? FailAwareState::kFailing
        : seconds <= params.thresholds.degradedWithin_s(road.speed_mps) ? FailAwareState::kDegraded
                                                                        : FailAwareState::kOk;
    if (output.state != FailAwareState::kFailed) {
      EXPECT_EQ(output.state, expected) << seconds;
    } else {
      EXPECT_LE(seconds, 0.0);
    }
    last = output.state;
    seen[static_cast<int>(last)] = true;
  }
  EXPECT_TRUE(seen[2] && seen[3] && seen[4]);
}

TEST(FailAwareMonitor, ResetForgetsTheDriveAndKeepsServing) {
  FailAwareMonitor monitor{independentSweeps()};
  Road road;
  monitor.start();
  drive(monitor, road, 50);
  monitor.reset();
  EXPECT_TRUE(monitor.started());
  Road again;  // stamps go back
  const MonitorOutput first = drive(monitor, again, 1);
  EXPECT_EQ(first.state, FailAwareState::kUnknown);
  EXPECT_EQ(first.eta, 0.0);
  EXPECT_FALSE(first.time_to_failure.isKnown());
  const MonitorOutput later = drive(monitor, again, 9);
  EXPECT_EQ(later.state, FailAwareState::kOk);
  EXPECT_NEAR(later.sigma_x_m, 0.01 * 3.0, 1e-6);

  FailAwareMonitor not_started{independentSweeps()};
  drive(not_started, again, 3);
  not_started.reset();
  EXPECT_FALSE(not_started.started());
  EXPECT_EQ(drive(not_started, again, 3).state, FailAwareState::kUnknown);
}

TEST(FailAwareMonitor, AStandingVehicleHasAnswersToo) {
  FailAwareMonitor monitor{independentSweeps()};
  Road road;
  road.speed_mps = 0.0;
  road.sigma_m = 0.0;
  road.sigma_yaw_step_rad = 0.0;
  monitor.start();
  const MonitorOutput output = drive(monitor, road, 20);
  expectFinite(output);
  EXPECT_EQ(output.time_to_failure.status, TimeToFailureStatus::kBeyondHorizon);
  EXPECT_EQ(output.state, FailAwareState::kOk);
}

TEST(FailAwareMonitor, WhateverComesInNoNanComesOut) {
  const std::function<void(FilterState&)> faults[] = {
      [](FilterState& s) { s.registration_covariance.setConstant(kNan); },
      [](FilterState& s) { s.registration_covariance(0, 0) = kInf; },
      [](FilterState& s) { s.registration_covariance.diagonal().setConstant(-1.0); },
      [](FilterState& s) { s.registration_covariance.diagonal().setConstant(1e300); },
      [](FilterState& s) { s.sigma_yaw_rad = kNan; },
      [](FilterState& s) { s.sigma_yaw_rad = kInf; },
      [](FilterState& s) { s.sigma_yaw_rad = 1e5; },
      [](FilterState& s) { s.T_odom_cog.matrix()(0, 3) = kNan; },
      [](FilterState& s) { s.T_previous_now.matrix()(0, 3) = kNan; },
      [](FilterState& s) { s.dt_s = kNan; },
      [](FilterState& s) { s.dt_s = 1e-300; },
      [](FilterState& s) { s.stamp_s -= 100.0; },
      [](FilterState& s) { s.fusion.disagreement_m = kNan; },
  };
  for (const auto& fault : faults) {
    for (const int fault_at : {0, 1, 10}) {  // 0: at t1
      FailAwareMonitor monitor{independentSweeps()};
      Road road;
      monitor.start();
      for (int i = 0; i < 20; ++i) {
        FilterState state = road.next();
        if (i == fault_at) fault(state);
        SweepCondition condition;
        if (i == fault_at) condition.min_information_ratio = kNan;
        expectFinite(monitor.update(state, condition));
      }
    }
  }
}

TEST(FailAwareMonitor, BadIncrementIsUnboundedUntilStart) {
  FailAwareMonitor monitor{independentSweeps()};
  Road road;
  monitor.start();
  ASSERT_EQ(drive(monitor, road, 20).state, FailAwareState::kOk);
  const std::function<void(FilterState&)> faults[] = {
      [](FilterState& s) { s.registration_covariance.setConstant(kNan); },
      [](FilterState& s) { s.T_odom_cog.matrix()(0, 3) = kNan; },
      [](FilterState& s) { s.dt_s = kNan; },
  };
  for (const auto& fault : faults) {
    FilterState state = road.next();
    fault(state);
    monitor.update(state, {});
    const MonitorOutput output = drive(monitor, road, 20);
    EXPECT_EQ(output.state, FailAwareState::kFailed);
    EXPECT_EQ(output.time_to_failure.status, TimeToFailureStatus::kReached);
    EXPECT_TRUE(output.reasons & kReasonCovarianceLimit);
    EXPECT_EQ(output.protection_level_m, 1e6);
    expectFinite(output);
    monitor.start();
    EXPECT_EQ(drive(monitor, road, 20).state, FailAwareState::kOk);
  }
}

TEST(FailAwareMonitor, ParametersAreChecked) {
  const auto refused = [](const std::function<void(MonitorParameters&)>& change) {
    MonitorParameters params = independentSweeps();
    change(params);
    return errorOf([&] { validate(params); });
  };
  EXPECT_EQ(refused([](MonitorParameters&) {}), "no error");
  EXPECT_NE(refused([](MonitorParameters& p) { p.sweeps_to_recover = 0; }).find("sweeps_to_recover"),
            std::string::npos);
  EXPECT_NE(refused([](MonitorParameters& p) { p.disagreement_m = 0.0; }).find("disagreement_m"), std::string::npos);
  EXPECT_NE(refused([](MonitorParameters& p) { p.min_information_ratio = 1.1; }).find("min_information_ratio"),
            std::string::npos);
  EXPECT_NE(refused([](MonitorParameters& p) { p.rate_window_s = kNan; }).find("rate_window_s"), std::string::npos);
  EXPECT_NE(refused([](MonitorParameters& p) { p.thresholds.degraded_s = 0.5; }).find("degraded_s"), std::string::npos);
  EXPECT_NE(refused([](MonitorParameters& p) { p.indicator.horizon_s = 30.0; }).find("predictor.horizon_s"),
            std::string::npos);
  EXPECT_NE(refused([](MonitorParameters& p) {
              p.indicator.horizon_s = p.predictor.horizon_s = 10.0;
            }).find("thresholds.degraded_s"),
            std::string::npos)
      << "it would be DEGRADED for ever";
}

TEST(FailAwareMonitor, ASweepThatComesTooLateTellsOfMissingOnes) {
  FailAwareMonitor monitor{independentSweeps()};
  Road road;
  drive(monitor, road, 20);
  const auto reasonsAfter = [&](double dt_s) {
    FilterState state = road.next();
    state.dt_s = dt_s;
    return monitor.update(state, {}).reasons & kReasonDroppedSweeps;
  };
  EXPECT_EQ(reasonsAfter(0.16), 0u);
  EXPECT_NE(reasonsAfter(0.2), 0u);
  EXPECT_EQ(reasonsAfter(0.1), 0u) << "only the sweep that follows the gap";
  for (int i = 0; i < 12; ++i) reasonsAfter(0.2);
  EXPECT_EQ(reasonsAfter(0.2), 0u) << "by now the usual period";
  monitor.reset();
  EXPECT_EQ(reasonsAfter(0.3), 0u) << "nothing is usual yet";
}

TEST(FailAwareMonitor, APoseThatIsSetIsANewT1OnceItServes) {
  FailAwareMonitor monitor{independentSweeps()}, idle{independentSweeps()};
  Road road, idle_road;
  drive(idle, idle_road, 50);
  FilterState state = idle_road.next();
  state.odom_reset_count = 1;
  EXPECT_FALSE(idle.update(state, {}).time_to_failure.isKnown()) << "it does not serve";
  monitor.start();
  const double sigma_before_m = drive(monitor, road, 50).sigma_x_m;
  EXPECT_GT(sigma_before_m, 0.0);
  const Pose T_new_old =
      Pose(Eigen::Translation3d(300.0, -40.0, 0.0)) * Pose(Eigen::AngleAxisd(2.0, Eigen::Vector3d::UnitZ()));
  for (int i = 0; i < 10; ++i) {
    state = road.next();
    state.T_odom_cog = T_new_old * state.T_odom_cog;
    state.odom_reset_count = 1;
    const MonitorOutput output = monitor.update(state, {});
    EXPECT_TRUE(output.time_to_failure_covariance.isKnown()) << "the rates are still known";
    EXPECT_NEAR(output.sigma_x_m, road.sigma_m * std::sqrt(i), 1e-9) << "no lever arm to where odom was";
    EXPECT_LT(output.sigma_y_m, 0.05);
  }
}

}  // namespace
}  // namespace fail_aware::monitor_test
