#include "core/estimation/pose_filter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "../../support/poses.hpp"
#include "../parameters/error_of.hpp"
#include "core/estimation/increment_covariance.hpp"
#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::pose_filter_test {
namespace {

constexpr double kDt_s = 0.1;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

PoseFilter makeFilter(const PoseFilter::Params& params = {}) {
  return PoseFilter(params, VehicleModel(VehicleParameters(), VehicleModel::Params()), MotionHistory::Params(),
                    MeasurementFusion());
}

Matrix6d diagonal(double sigma_m, double sigma_rad) {
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(sigma_m * sigma_m), Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  return variances.asDiagonal();
}

Measurement measured(const Pose& T_odom_cog, const Matrix6d& covariance = diagonal(0.01, 1e-3)) {
  Measurement measurement;
  measurement.status = MeasurementStatus::kOk;
  measurement.T_odom_cog = T_odom_cog;
  measurement.covariance = covariance;
  measurement.inlier_ratio = 1.0;
  return measurement;
}

/// Constant forward speed and yaw rate from `T_start`.
struct Drive {
  double speed_mps = 14.0;
  double yaw_rate_rps = 0.0;
  Pose T_start = Pose::Identity();

  double stamp(int sweep) const { return 100.0 + kDt_s * sweep; }
  Pose at(int sweep) const {
    Vector6d twist = Vector6d::Zero();
    twist[0] = speed_mps;
    twist[5] = yaw_rate_rps;
    return T_start * expSe3(kDt_s * sweep * twist);
  }
};

struct Step {
  SweepPrediction prediction;
  FilterState state;
};

Step step(PoseFilter& filter, double stamp_s, const std::vector<Measurement>& measurements) {
  Step out;
  EXPECT_TRUE(filter.predict(stamp_s, out.prediction));
  std::vector<FusionInput> inputs;
  for (const Measurement& m : measurements) inputs.push_back({"m", &m});
  out.state = filter.correct(inputs);
  return out;
}

/// Sweeps 0 (without a measurement: it defines the pose) to `last`, measured exactly.
Step driveMeasured(PoseFilter& filter, const Drive& drive, int last) {
  filter.reset(drive.T_start);
  Step out = step(filter, drive.stamp(0), {});
  for (int i = 1; i <= last; ++i) out = step(filter, drive.stamp(i), {measured(drive.at(i))});
  return out;
}

double distance(const Pose& a, const Pose& b) { return (a.translation() - b.translation()).norm(); }
double angle(const Pose& a, const Pose& b) { return logSo3(a.linear().transpose() * b.linear()).norm(); }

/// A vehicle that brakes, seen by a lidar whose stamps are -middle_s from its sweeps' middles: each sweep is measured
/// where the speed that it was corrected for puts it. Returns the greatest error of a predicted increment.
double worstPredictionInBraking(double middle_s, double told_middle_s) {
  const auto distance_m = [](double t_s) { return 12.0 * t_s - std::pow(std::max(0.0, t_s - 2.0), 2); };
  PoseFilter filter = makeFilter();
  double worst_m = 0.0;
  for (int i = 0; i <= 60; ++i) {
    SweepPrediction prediction;
    EXPECT_TRUE(filter.predict(100.0 + kDt_s * i, prediction));
    const double t_s = kDt_s * i, driven_m = distance_m(t_s) - distance_m(t_s - kDt_s);
    double predicted_m = prediction.T_previous_now().translation().x();
    if (i > 30) worst_m = std::max(worst_m, std::abs(predicted_m - driven_m));
    if (!prediction.motionKnown()) predicted_m = driven_m;  // searched for
    const double x_m = distance_m(t_s + middle_s) - predicted_m * middle_s / kDt_s;
    const Measurement measurement = measured(pose(x_m, 0, 0, 0, 0, 0));
    SweepFindings findings;
    findings.middle_s = told_middle_s;
    filter.correct({{"m", i > 0 ? &measurement : nullptr}}, findings);
  }
  return worst_m;
}

TEST(PoseFilter, ALostSweepThatTheStampsDoNotCountIsNoMotion) {
  PoseFilter filter = makeFilter();
  const Drive drive;
  FilterState state;
  for (int i = 0; i <= 24; ++i) {
    const int driven = i + (i >= 20 ? 1 : 0);
    Measurement measurement = measured(drive.at(driven));
    measurement.inliers = 1000;
    measurement.rms_residual_m = 0.02;
    SweepTime time(drive.stamp(i));
    time.period_s = kDt_s;
    SweepPrediction prediction;
    ASSERT_TRUE(filter.predict(time, prediction));
    const double off_m = distance(prediction.T_odom_cog, drive.at(driven));
    const Measurement* given = i > 0 ? &measurement : nullptr;
    state = filter.correct({{kIcpPointToPoint, given}, {kIcpPointToPlane, given}});
    EXPECT_EQ(state.clock_jump, i == 20) << i;
    EXPECT_TRUE(i < 20 || state.doubt.sigma_m == 0.0) << i;
    EXPECT_TRUE(i <= 20 || off_m < 0.1) << i << ": the speed is as before";
  }
  EXPECT_LT(distance(state.T_odom_cog, drive.at(25)), 0.05);
}

TEST(PoseFilter, SpeedErrorDoesNotFeedBack) {
  for (const double middle_s : {-0.05, 0.0, 0.05}) {
    EXPECT_LT(worstPredictionInBraking(middle_s, middle_s), 1e-3) << middle_s;
  }
  EXPECT_GT(worstPredictionInBraking(-0.05, 0.0), 0.01) << "taken from the poses at the stamps it does";
}

TEST(PoseFilter, LostMotionIsUnknownUntilMeasuredAgain) {
  PoseFilter filter = makeFilter();
  Drive drive;
  filter.reset(drive.T_start);
  MotionStatus worst = MotionStatus::kObserved;
  bool restarted = false;
  for (int i = 0; i <= 80; ++i) {
    SweepPrediction prediction;
    ASSERT_TRUE(filter.predict(drive.stamp(i), prediction));
    Measurement planes = i > 0 ? measured(drive.at(i)) : Measurement();
    planes.inlier_ratio = i < 50 || restarted ? 0.9 : 0.45;
    if (i >= 30 && i < 50) planes.covariance.topLeftCorner<2, 2>() += 1e4 * Eigen::Matrix2d::Identity();  // a tunnel
    const FilterState& state = filter.correct({{kIcpPointToPlane, &planes}});
    if (i < 50) continue;
    restarted = restarted || state.map_update == MapUpdate::kRestart;
    if (state.motion_status == MotionStatus::kUnknown) worst = MotionStatus::kUnknown;
  }
  EXPECT_TRUE(restarted);
  EXPECT_EQ(worst, MotionStatus::kUnknown);
  EXPECT_TRUE(filter.state().motionObserved()) << "the search has found it again";
}

TEST(PoseFilter, TheFirstSweepDefinesThePose) {
  PoseFilter filter = makeFilter();
  const Pose T = pose(3.0, -2.0, 0.5, 0.01, -0.02, 1.2);
  filter.reset(T);
  const Step first = step(filter, 100.0, {Measurement()});
  EXPECT_TRUE(first.state.started);
  EXPECT_TRUE(first.prediction.T_odom_cog.isApprox(T, 1e-12));
  EXPECT_EQ(first.prediction.dt_s, 0.0);
  EXPECT_FALSE(first.prediction.motionKnown());
  EXPECT_TRUE(first.state.T_odom_cog.isApprox(T, 1e-12));
  EXPECT_EQ(first.state.stamp_s, 100.0);
  EXPECT_EQ(first.state.dt_s, 0.0);
  EXPECT_FALSE(first.state.measurement_applied);
  EXPECT_TRUE(first.state.T_previous_now.isApprox(Pose::Identity()));
  EXPECT_TRUE(first.state.increment_covariance.isZero());
  EXPECT_NEAR(first.state.sigma_yaw_rad, PoseFilter::Params().initial_sigma_deg * kDegree, 1e-9);
}

TEST(PoseFilter, ClockJumpIsAPoseAndNoMotion) {
  PoseFilter filter = makeFilter();
  const Drive drive;
  const Step usual = driveMeasured(filter, drive, 8);
  Pose T_odom_cog = drive.at(9);
  T_odom_cog.translation().x() += 5.0;
  Measurement doubted = measured(T_odom_cog);
  doubted.clock_jump_suspected = true;
  // what began at the stamps' place and was not found elsewhere is not heard, and one that was is enough
  const Measurement by_the_stamps = measured(drive.at(9));
  const Step aside = step(filter, drive.stamp(9), {doubted, by_the_stamps, by_the_stamps});
  EXPECT_TRUE(aside.state.clock_jump && aside.state.fusion.prediction_overruled);
  EXPECT_EQ(aside.state.fusion.weights[1], 0.0);
  EXPECT_TRUE(aside.state.inMap());
  EXPECT_LT(distance(aside.state.T_odom_cog, T_odom_cog), 0.005);
  EXPECT_GT(aside.state.increment_covariance(0, 0), usual.state.increment_covariance(0, 0))
      << "the prediction adds nothing to what is known";
  const FilterState driven = filter.stateAsDriven();
  EXPECT_LT(distance(driven.T_previous_now, usual.state.T_previous_now), 0.05) << "no car makes that way";
  EXPECT_GT(driven.increment_covariance(0, 0), 0.01) << "known to 1 m/s, 0.1 m a sweep";
  EXPECT_TRUE(driven.T_odom_cog.isApprox(aside.state.T_odom_cog, 1e-12));
  for (int i = 10; i < 14; ++i) {
    T_odom_cog.translation().x() += 1.4;
    const Step next = step(filter, drive.stamp(i), {measured(T_odom_cog)});
    EXPECT_LT(distance(next.prediction.T_odom_cog, T_odom_cog), 0.05) << i;
    EXPECT_TRUE(filter.stateAsDriven().T_previous_now.isApprox(next.state.T_previous_now, 0.0)) << i;
  }
}

TEST(PoseFilter, BeforeAMotionIsMeasuredThereIsNone) {
  PoseFilter filter = makeFilter();
  const Drive drive;
  step(filter, drive.stamp(0), {});
  EXPECT_EQ(filter.stateAsDriven().dt_s, 0.0);
  const Step predicted = step(filter, drive.stamp(1), {});
  EXPECT_NEAR(predicted.state.dt_s, kDt_s, 1e-9);
  EXPECT_EQ(filter.stateAsDriven().dt_s, 0.0) << "it stands in the prediction only";
  step(filter, drive.stamp(2), {measured(drive.at(2))});
  EXPECT_NEAR(filter.stateAsDriven().dt_s, kDt_s, 1e-9);
  step(filter, drive.stamp(3), {});
  EXPECT_NEAR(filter.stateAsDriven().dt_s, kDt_s, 1e-9) << "from here on a prediction has a motion";
}

TEST(PoseFilter, APoseFromElsewhereDoubtsNoInterval) {
  PoseFilter filter = makeFilter();
  const Drive drive;
  driveMeasured(filter, drive, 8);
  Measurement elsewhere = measured(drive.at(9));
  elsewhere.clock_jump_suspected = true;
  SweepPrediction prediction;
  SweepTime time(drive.stamp(9));
  time.set_back_s = 0.3;
  ASSERT_TRUE(filter.predict(time, prediction));
  EXPECT_EQ(prediction.set_back_s, 0.3);
  const Measurement usual = measured(drive.at(9));
  const FilterState& state = filter.correct({{"m", &usual}, {"elsewhere", &elsewhere, FusionInput::Kind::kExternal}});
  EXPECT_FALSE(state.clock_jump || state.fusion.prediction_overruled);
  EXPECT_EQ(state.set_back_s, 0.3);
  EXPECT_GT(state.fusion.weights[0], 0.0);
}

TEST(PoseFilter, StampNotAdvancingIsRefused) {
  PoseFilter filter = makeFilter(), undisturbed = makeFilter();
  const Drive drive;
  driveMeasured(filter, drive, 5);
  driveMeasured(undisturbed, drive, 5);
  const Pose before = filter.state().T_odom_cog;
  for (const double stamp_s : {drive.stamp(5), drive.stamp(4), -1.0, kNan, std::numeric_limits<double>::infinity()}) {
    SweepPrediction prediction;
    prediction.stamp_s = 7.0;
    EXPECT_FALSE(filter.predict(stamp_s, prediction)) << stamp_s;
    EXPECT_EQ(prediction.stamp_s, 7.0);
    EXPECT_EQ(filter.state().stamp_s, drive.stamp(5));
    EXPECT_TRUE((filter.state().T_odom_cog.matrix().array() == before.matrix().array()).all());
  }
  const Step after = step(filter, drive.stamp(6), {measured(drive.at(6))});
  const Step expected = step(undisturbed, drive.stamp(6), {measured(drive.at(6))});
  EXPECT_TRUE((after.state.T_odom_cog.matrix().array() == expected.state.T_odom_cog.matrix().array()).all());
}

TEST(PoseFilter, TracksADriveWithConstantVelocity) {
  for (const double yaw_rate_rps : {0.0, 0.3, -0.3}) {
    PoseFilter filter = makeFilter();
    Drive drive;
    drive.yaw_rate_rps = yaw_rate_rps;
    drive.T_start = pose(5.0, 1.0, 0.5, 0.0, 0.0, 2.8);  // the left turn passes +-pi
    driveMeasured(filter, drive, 1);
    EXPECT_LT(distance(filter.state().T_odom_cog, drive.at(1)), 0.01) << "the first motion is measured, not assumed";
    for (int i = 2; i <= 60; ++i) {
      const Step now = step(filter, drive.stamp(i), {measured(drive.at(i))});
      ASSERT_TRUE(now.state.measurement_applied) << i;
      EXPECT_EQ(now.prediction.motionKnown(), true);
      EXPECT_NEAR(now.prediction.dt_s, kDt_s, 1e-9);
      EXPECT_LT(distance(now.state.T_odom_cog, drive.at(i)), 0.005) << i;
      EXPECT_LT(angle(now.state.T_odom_cog, drive.at(i)), 1e-3) << i;
      if (i < 8) continue;  // the derivatives have settled
      EXPECT_LT(distance(now.prediction.T_odom_cog, drive.at(i)), 0.03) << i;
      EXPECT_LT(angle(now.prediction.T_odom_cog, drive.at(i)), 1e-3) << i;
      EXPECT_LT(distance(now.state.T_previous_now, drive.at(i - 1).inverse() * drive.at(i)), 0.005) << i;
    }
  }
}

TEST(PoseFilter, UnknownMotionIsUncertainAlongRoad) {
  PoseFilter filter = makeFilter();
  filter.reset(pose(0.0, 0.0, 0.0, 0.0, 0.0, 0.5 * M_PI));  // the road runs along odom's y
  step(filter, 0.0, {});
  SweepPrediction prediction;
  ASSERT_TRUE(filter.predict(kDt_s, prediction));
  EXPECT_FALSE(prediction.motionKnown());
  EXPECT_NEAR(std::sqrt(prediction.covariance(1, 1)), 15.0 * kDt_s, 0.01);
  EXPECT_LT(std::sqrt(prediction.covariance(0, 0)), 0.05);

  const Measurement sideways = measured(pose(1.4, 0.0, 0.0, 0.0, 0.0, 0.5 * M_PI));
  EXPECT_FALSE(filter.correct({{"m", &sideways}}).measurement_applied);
  const Measurement forward = measured(pose(0.0, 2.8, 0.0, 0.0, 0.0, 0.5 * M_PI));
  EXPECT_TRUE(step(filter, 2.0 * kDt_s, {forward}).state.measurement_applied);
}

TEST(PoseFilter, NoMeasurementIsThePrediction) {
  PoseFilter filter = makeFilter();
  const Drive drive;
  driveMeasured(filter, drive, 10);
  const double sigma_before = filter.state().sigma_yaw_rad;
  Measurement failed = measured(pose(0, 0, 0, 0, 0, 0));
  failed.status = MeasurementStatus::kNotConverged;
  Measurement nan = measured(drive.at(11));
  nan.covariance(0, 0) = kNan;
  Measurement far_off = measured(drive.at(11) * pose(0.0, 5.0, 0.0, 0.0, 0.0, 0.0));
  int sweep = 11;
  for (const std::vector<Measurement>& measurements :
       {std::vector<Measurement>{}, {failed}, {nan}, {far_off}, {Measurement(), failed, nan}}) {
    const Step now = step(filter, drive.stamp(sweep), measurements);
    EXPECT_FALSE(now.state.measurement_applied);
    EXPECT_FALSE(now.state.fusion.has_measurement);
    EXPECT_TRUE(now.state.T_odom_cog.isApprox(now.prediction.T_odom_cog, 1e-12));
    EXPECT_EQ(now.state.filter_nis, 0.0);
    EXPECT_EQ(now.state.fusion.weights.size(), measurements.size());
    EXPECT_GT(now.state.sigma_yaw_rad, sigma_before);
    ++sweep;
  }
  EXPECT_TRUE(step(filter, drive.stamp(sweep), {measured(drive.at(sweep))}).state.measurement_applied);
  EXPECT_LT(distance(filter.state().T_odom_cog, drive.at(sweep)), 0.01) << "and comes back";
}

TEST(PoseFilter, CoastsAtTheLastSpeedWithoutRunningAway) {
  for (const double yaw_rate_rps : {0.0, 0.2, -0.7}) {
    PoseFilter filter = makeFilter();
    Drive drive;
    drive.yaw_rate_rps = yaw_rate_rps;
    filter.reset(drive.T_start);
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    step(filter, drive.stamp(0), {});
    int i = 1;
    for (; i <= 30; ++i) {  // noise in pitch and height is what feeds on itself
      const Pose noise = pose(0.01 * normal(random), 0.01 * normal(random), 0.01 * normal(random),
                              0.002 * normal(random), 0.002 * normal(random), 0.001 * normal(random));
      step(filter, drive.stamp(i), {measured(drive.at(i) * noise)});
    }
    const Pose T_begin = filter.state().T_odom_cog;
    double steady_step_m = 0.0;  // the first one still carries the last measured acceleration
    for (int coasted = 1; coasted <= 600; ++coasted, ++i) {
      const FilterState state = step(filter, drive.stamp(i), {}).state;
      ASSERT_TRUE(isFinite(state.T_odom_cog) && state.covariance.allFinite());
      const double step_m = state.T_previous_now.translation().norm();
      ASSERT_NEAR(step_m, 1.4, 0.1) << coasted;
      if (coasted == 2) steady_step_m = step_m;
      if (coasted > 2) {
        ASSERT_NEAR(step_m, steady_step_m, 0.01 * steady_step_m) << coasted;
      }
      const Eigen::Vector3d rpy = rpyFromRotation(state.T_odom_cog.linear());
      ASSERT_LT(rpy.head<2>().cwiseAbs().maxCoeff(), 0.06) << coasted;
    }
    EXPECT_LT(std::abs(filter.state().T_odom_cog.translation().z()), 25.0) << "three per cent of the way";
    if (yaw_rate_rps != 0.0) continue;
    EXPECT_NEAR(distance(T_begin, filter.state().T_odom_cog), 600.0 * steady_step_m, 10.0);
  }
}

/// An acceleration of the last moment lasts for the push on a pedal, not for the gap.
TEST(PoseFilter, OverALongIntervalThePushOnAPedalFades) {
  PoseFilter filter = makeFilter();
  const auto at = [](double t_s) { return pose(10.0 * t_s + 1.5 * t_s * t_s, 0, 0, 0, 0, 0.15 * t_s * t_s); };
  step(filter, 100.0, {});
  for (int i = 1; i <= 10; ++i) step(filter, 100.0 + kDt_s * i, {measured(at(kDt_s * i))});
  const Pose T_begin = filter.state().T_odom_cog;
  SweepPrediction prediction;
  ASSERT_TRUE(filter.predict(104.0, prediction));  // 3 s at 13 m/s, 3 m/s^2, 0.3 rad/s, 0.3 rad/s^2
  const Pose T_begin_now = T_begin.inverse() * prediction.T_odom_cog;
  EXPECT_LT(std::abs(rpyFromRotation(T_begin_now.linear()).z()), 1.2) << "0.9 by the rate, 2.2 with the acceleration";
  EXPECT_LT(T_begin_now.translation().norm(), 3.0 * 13.0 + 5.0);
  const FilterState state = filter.correct({});
  EXPECT_GT(std::sqrt(state.increment_covariance(0, 0)), 1.0) << "what a driver may do in 3 s";
}

TEST(PoseFilter, AfterALongIntervalItDrivesOnAsFast) {
  for (const double gap_s : {1.0, 3.0, 5.0, 20.0}) {
    PoseFilter filter = makeFilter();
    const Drive drive;
    driveMeasured(filter, drive, 20);
    step(filter, drive.stamp(20) + gap_s, {});
    const FilterState state = step(filter, drive.stamp(21) + gap_s, {}).state;
    EXPECT_NEAR(state.T_previous_now.translation().x(), 1.4, 0.1) << gap_s;
  }
}

/// From a predicted to a measured pose the increment takes back the prediction's error.
TEST(PoseFilter, TheTwistAfterABlindSecondIsNoCorrection) {
  PoseFilter filter = makeFilter();
  const Drive drive;
  driveMeasured(filter, drive, 20);
  for (int i = 21; i <= 30; ++i) step(filter, drive.stamp(i), {});
  const Pose T_odom_braked = drive.at(31) * pose(-0.5, 0, 0, 0, 0, 0);
  step(filter, drive.stamp(31), {measured(T_odom_braked)});
  ASSERT_LT(filter.state().T_previous_now.translation().x(), 1.1) << "the correction";
  const FilterState state = filter.stateAsDriven();
  EXPECT_NEAR(state.T_previous_now.translation().x() / state.dt_s, 13.0, 1.5);
  EXPECT_GT(std::sqrt(state.increment_covariance(0, 0)) / state.dt_s, 0.9);
  EXPECT_NEAR(step(filter, drive.stamp(32), {measured(drive.at(32) * pose(-0.5, 0, 0, 0, 0, 0))}).state.dt_s, kDt_s,
              1e-6);
  EXPECT_EQ(filter.stateAsDriven().increment_covariance, filter.state().increment_covariance);
}

PoseFilter filterAtTheStartOf(const Drive& drive) {
  PoseFilter filter = makeFilter();
  filter.reset(drive.T_start);
  step(filter, drive.stamp(0), {});
  return filter;
}

/// Nothing observes the way along the road.
Measurement measuredAcrossOnly(const Pose& T_odom_cog) {
  Measurement open = measured(T_odom_cog);
  open.covariance(0, 0) = 900.0;
  return open;
}

// A tunnel that is seen from the first sweep on: at first "still here", with R that means nothing; then observed,
// against the map that was made at this speed.
TEST(PoseFilter, GuessedSpeedIsNotConfirmedByItsOwnMap) {
  const auto statusWhenObserved = [](int unobserved_sweeps) {
    const Drive standing{0.0};
    PoseFilter filter = filterAtTheStartOf(standing);
    const Measurement open = measuredAcrossOnly(Pose::Identity());
    for (int i = 1; i <= unobserved_sweeps; ++i) step(filter, standing.stamp(i), {open});
    EXPECT_FALSE(filter.state().motionObserved());
    for (int i = 1; i <= 20; ++i) {
      const FilterState state = step(filter, standing.stamp(unobserved_sweeps + i), {measured(Pose::Identity())}).state;
      if (state.motionObserved()) return MotionStatus::kObserved;
      if (state.map_update == MapUpdate::kRestart) return state.motion_status;
    }
    return MotionStatus::kDeadReckoning;
  };
  EXPECT_EQ(statusWhenObserved(3), MotionStatus::kObserved) << "hardly a map";
  EXPECT_EQ(statusWhenObserved(12), MotionStatus::kUnknown) << "the motion is searched for";
}

TEST(PoseFilter, AGuessedStandstillIsSearchedAgainEverRarer) {
  const Drive standing{0.0};
  PoseFilter filter = filterAtTheStartOf(standing);
  const Measurement open = measuredAcrossOnly(Pose::Identity());
  std::vector<int> searches;
  for (int i = 1; i <= 160; ++i) {
    const FilterState state = step(filter, standing.stamp(i), {open}).state;
    if (i > 1 && state.map_update == MapUpdate::kRestart) {
      searches.push_back(i);
      EXPECT_EQ(state.motion_status, MotionStatus::kUnknown);
    }
  }
  EXPECT_EQ(searches, (std::vector<int>{20, 60, 140}));
}

TEST(PoseFilter, UnobservedSpeedIsHeld) {
  PoseFilter filter = makeFilter();
  Drive drive;
  drive.T_start = pose(0.0, 0.0, 0.0, 0.0, 0.0, 0.7);
  driveMeasured(filter, drive, 15);
  // A tunnel: along the road the measurement says "still where the last sweep was", with R that means nothing.
  Vector6d sigmas_body;
  sigmas_body << 30.0, 0.01, 0.01, 1e-3, 1e-3, 1e-3;
  const Matrix6d R = rotateCovariance(sigmas_body.cwiseAbs2().asDiagonal(), drive.T_start.linear());
  for (int i = 16; i <= 115; ++i) {
    const Pose T_last = filter.state().T_odom_cog;
    const Pose behind = pose(T_last.translation().x(), T_last.translation().y(), 0.0, 0.0, 0.0, 0.7);
    const Step now = step(filter, drive.stamp(i), {measured(behind, R)});
    ASSERT_TRUE(now.state.measurement_applied) << i;
    EXPECT_NEAR(distance(now.prediction.T_odom_cog_previous, now.prediction.T_odom_cog), 1.4, 0.014) << i;
    EXPECT_LT(std::abs((drive.T_start.inverse() * now.state.T_odom_cog).translation().y()), 0.02) << i;
  }
  // once the road is observed again, so is the speed
  Drive slower;
  slower.speed_mps = 13.0;
  slower.T_start = filter.state().T_odom_cog;
  const double stamp_s = filter.state().stamp_s;
  for (int i = 1; i <= 12; ++i) step(filter, stamp_s + i * kDt_s, {measured(slower.at(i))});
  EXPECT_NEAR(filter.state().T_previous_now.translation().x(), 1.3, 0.01);
}

// A tunnel: along the road a registration stays at the prediction, and says so.
TEST(PoseFilter, WhereNothingObservesThePoseItsCovarianceGrows) {
  PoseFilter filter = makeFilter();
  const Drive drive;
  driveMeasured(filter, drive, 15);
  Vector6d sigmas;
  sigmas << 3.0, 0.01, 0.01, 1e-3, 1e-3, 1e-3;
  double variance_after_50 = 0.0;
  for (int i = 1; i <= 200; ++i) {
    SweepPrediction prediction;
    ASSERT_TRUE(filter.predict(drive.stamp(15 + i), prediction));
    const Measurement m = measured(prediction.T_odom_cog, sigmas.cwiseAbs2().asDiagonal());
    const FilterState state = filter.correct({{"m", &m}});
    if (i == 50) variance_after_50 = state.covariance(0, 0);
  }
  EXPECT_GT(filter.state().covariance(0, 0), 3.0 * variance_after_50);
}

TEST(PoseFilter, IncrementCovarianceIsOneKalmanStep) {
  PoseFilter::Params params;
  params.increment_floor_m = 0.0;
  params.increment_per_metre_m = 0.0;
  params.increment_floor_deg = 0.0;
  params.increment_scale = 2.0;
  PoseFilter filter = makeFilter(params);
  Drive drive;
  drive.T_start = pose(0.0, 0.0, 0.0, 0.0, 0.0, 0.5 * M_PI);  // body x = odom y, body y = -odom x
  driveMeasured(filter, drive, 10);
  Vector6d sigmas_odom;
  sigmas_odom << 0.03, 0.04, 0.05, 0.01, 0.02, 0.0025;
  const Measurement m = measured(drive.at(11), sigmas_odom.cwiseAbs2().asDiagonal());
  const Matrix6d C = step(filter, drive.stamp(11), {m}).state.increment_covariance;
  expectCovariance(C, "measured");
  const VehicleModel::Params q;
  const auto kalman = [](double sigma_q, double sigma_r) {
    return 2.0 * sigma_q * sigma_q * sigma_r * sigma_r / (sigma_q * sigma_q + sigma_r * sigma_r);
  };
  EXPECT_NEAR(C(0, 0), kalman(q.sigma_x_m, 0.04), 1e-5);
  EXPECT_NEAR(C(1, 1), kalman(q.sigma_y_m, 0.03), 1e-5);
  EXPECT_NEAR(C(2, 2), kalman(q.sigma_z_m, 0.05), 1e-5);
  EXPECT_NEAR(C(5, 5), kalman(q.sigma_yaw_rad, 0.0025), 1e-7);

  const Matrix6d dead_reckoning = step(filter, drive.stamp(12), {}).state.increment_covariance;
  EXPECT_NEAR(dead_reckoning(0, 0), 2.0 * q.sigma_x_m * q.sigma_x_m, 1e-5);
  EXPECT_NEAR(dead_reckoning(5, 5), 2.0 * q.sigma_yaw_rad * q.sigma_yaw_rad, 1e-7);
}

TEST(PoseFilter, TheIncrementsCovarianceIsOneAndGrowsWhenCoasting) {
  PoseFilter filter = makeFilter();
  Drive drive;
  drive.yaw_rate_rps = 0.1;
  const Matrix6d observed = driveMeasured(filter, drive, 10).state.increment_covariance;
  expectCovariance(observed, "measured");
  const double floor_m = 0.001 + 0.001 * 1.4;
  EXPECT_GT(observed(0, 0), floor_m * floor_m);
  const Matrix6d dead_reckoning = step(filter, drive.stamp(11), {}).state.increment_covariance;
  expectCovariance(dead_reckoning, "dead_reckoning");
  for (int i = 0; i < 6; ++i) EXPECT_GT(dead_reckoning(i, i), observed(i, i)) << i;
  const Matrix6d longer = step(filter, drive.stamp(14), {}).state.increment_covariance;
  EXPECT_GT(longer(5, 5) / dead_reckoning(5, 5), 3.0) << "three sweep periods, and the yaw rate's uncertainty";

  int sweep = 15;
  for (const double sigma : {1e-7, 1e-3, 1.0, 1e4, 1e9}) {
    const Step now = step(filter, drive.stamp(sweep), {measured(drive.at(sweep), diagonal(sigma, sigma))});
    expectCovariance(now.state.increment_covariance, "R = " + std::to_string(sigma));
    expectCovariance(now.state.covariance, "P for R = " + std::to_string(sigma));
    ++sweep;
  }
}

TEST(PoseFilter, WhereItCoastsTheIncrementIsThatMuchLessSure) {
  Matrix6d observed[2], dead_reckoning[2];
  for (const int factor : {1, 2}) {
    PoseFilter::Params params;
    params.increment_floor_m = params.increment_per_metre_m = params.increment_floor_deg = 0.0;
    params.dead_reckoning_increment_factor = factor;
    PoseFilter filter = makeFilter(params);
    const Drive drive;
    observed[factor - 1] = driveMeasured(filter, drive, 10).state.increment_covariance;
    step(filter, drive.stamp(11), {});  // from here on the speed is unsure
    dead_reckoning[factor - 1] = step(filter, drive.stamp(12), {}).state.increment_covariance;
  }
  EXPECT_TRUE(observed[1].isApprox(observed[0], 1e-9));
  EXPECT_TRUE(dead_reckoning[1].isApprox(2.0 * dead_reckoning[0], 1e-9));
}

TEST(PoseFilter, MeasurementsThatStayApartAddTheirDisagreement) {
  const Drive drive;
  const auto variancesWith = [&](int apart_sweeps) {
    PoseFilter filter = makeFilter();
    driveMeasured(filter, drive, 20);
    Step out;
    for (int i = 21; i <= 27; ++i) {
      const Pose T = drive.at(i);
      const double apart_m = i > 27 - apart_sweeps ? 0.25 : 0.0;
      const Pose T_left = Pose(Eigen::Translation3d(0.0, 0.5 * apart_m, 0.0)) * T;
      const Pose T_right = Pose(Eigen::Translation3d(0.0, -0.5 * apart_m, 0.0)) * T;
      const Matrix6d R = diagonal(0.05, 1e-3);
      out = step(filter, drive.stamp(i), {measured(T_left, R), measured(T_right, R)});
    }
    EXPECT_NEAR(out.state.fusion.disagreement_m, apart_sweeps > 0 ? 0.25 : 0.0, 1e-6);
    return Eigen::Vector2d(out.state.increment_covariance(1, 1), std::pow(out.state.doubt.sigma_m, 2));
  };
  const Eigen::Vector2d together = variancesWith(0), now_and_then = variancesWith(2), accumulated = variancesWith(4);
  EXPECT_TRUE(now_and_then.isApprox(together, 0.1)) << "two of the last five sweeps";
  EXPECT_NEAR(accumulated[0] - together[0], 0.1 * 0.1, 1e-4) << "beyond 0.15 m";
  EXPECT_NEAR(accumulated[1] - together[1], 0.1 * 0.1, 1e-4) << "it stays";
}

/// By the two ICPs, which measure the same and fit the map by that share.
FilterState correctByBoth(PoseFilter& filter, Measurement measurement, double inlier_ratio) {
  measurement.inlier_ratio = inlier_ratio;
  return filter.correct({{kIcpPointToPoint, &measurement}, {kIcpPointToPlane, &measurement}});
}

/// A drive of 20 good sweeps and 11 odd ones: the state after the last of them.
FilterState afterOddSweeps(const std::function<Measurement(int sweep, const Pose& T)>& odd,
                           const PoseFilter::Params& params = {}) {
  const Drive drive;
  PoseFilter filter = makeFilter(params);
  driveMeasured(filter, drive, 20);
  Step out;
  for (int i = 21; i <= 31; ++i) {
    const Measurement measurement = odd(i, drive.at(i));
    EXPECT_TRUE(filter.predict(drive.stamp(i), out.prediction));
    out.state = filter.correct({{kIcpPointToPoint, &measurement}, {kIcpPointToPlane, &measurement}});
    EXPECT_TRUE(out.state.measurement_applied);
  }
  return out.state;
}

PoseFilter::Params believingAll() {
  PoseFilter::Params params;
  params.consistency.persistent_innovation_m = params.consistency.fitting_ratio =
      params.consistency.max_yaw_innovation_deg = 0.0;
  return params;
}

/// What is not believed adds to the variances along the way, across it and of the heading.
Eigen::Vector3d addedVariances(const std::function<Measurement(int sweep, const Pose& T)>& odd) {
  const Matrix6d C =
      afterOddSweeps(odd).increment_covariance - afterOddSweeps(odd, believingAll()).increment_covariance;
  return {C(0, 0), C(1, 1), C(5, 5)};
}

std::function<Measurement(int sweep, const Pose& T)> jumping(double jump_m, const Matrix6d& R) {
  return [=](int sweep, const Pose& T) {
    return measured(Pose(Eigen::Translation3d(sweep % 2 == 0 ? 0.5 * jump_m : -0.5 * jump_m, 0.0, 0.0)) * T, R);
  };
}

TEST(PoseFilter, JumpingMeasurementsAreUncertain) {
  const double wild_m = std::sqrt(addedVariances(jumping(0.12, diagonal(0.01, 1e-3)))[0]);
  EXPECT_GT(wild_m, 0.1);
  EXPECT_LT(wild_m, 0.3);
  EXPECT_EQ(addedVariances(jumping(0.02, diagonal(0.01, 1e-3))).norm(), 0.0) << "as much as sound sweeps do";
}

TEST(PoseFilter, WhereItCoastsMeasurementsMayJump) {
  Matrix6d open_along = diagonal(0.01, 1e-3);
  open_along(0, 0) = 0.2 * 0.2;
  EXPECT_EQ(addedVariances(jumping(0.3, open_along)).norm(), 0.0) << "R says so itself";
}

TEST(PoseFilter, WhereNextToNothingFitsTheMapTheIncrementIsOpen) {
  const Eigen::Vector3d little = addedVariances([](int, const Pose& T) {
    Measurement measurement = measured(T);
    measurement.inlier_ratio = 0.1;
    return measurement;
  });
  EXPECT_NEAR(std::sqrt(little[0]), 0.25 * 2.0 / 3.0, 1e-4);
  EXPECT_NEAR(std::sqrt(little[1]), 0.25 * 2.0 / 3.0, 1e-4);
}

TEST(PoseFilter, WhatNextToNothingFitsTellsNoSpeed) {
  const Drive drive;
  struct Steps {
    double drifted_m, after_m;
  };
  const auto predictedSteps = [&](double share) {
    PoseFilter filter = makeFilter();
    driveMeasured(filter, drive, 20);
    int sweep = 20;
    SweepPrediction prediction;
    const auto predictedStep = [&] {
      EXPECT_TRUE(filter.predict(drive.stamp(++sweep), prediction));
      return prediction.T_previous_now().translation().x();
    };
    for (int i = 0; i < 5; ++i) {
      predictedStep();
      correctByBoth(filter, measured(drive.at(sweep)), 0.9);
    }
    Steps steps{};
    for (int i = 0; i < 20; ++i) {  // each is measured 5 cm ahead of where it was predicted to be
      steps.drifted_m = predictedStep();
      correctByBoth(filter, measured(prediction.T_odom_cog * pose(0.05, 0, 0, 0, 0, 0)), share);
    }
    for (int i = 0; i < 10; ++i) {  // found again: it has braked to 10 m/s
      predictedStep();
      correctByBoth(filter, measured(prediction.T_odom_cog_previous * pose(1.0, 0, 0, 0, 0, 0)), 0.9);
    }
    steps.after_m = predictedStep();
    return steps;
  };
  const Steps believed = predictedSteps(0.9), held = predictedSteps(0.1);
  EXPECT_GT(believed.drifted_m, 1.8) << "it runs after its own error";
  EXPECT_NEAR(held.drifted_m, 1.4, 0.1);
  EXPECT_NEAR(believed.after_m, 1.0, 0.05);
  EXPECT_NEAR(held.after_m, 1.0, 0.05);
}

TEST(PoseFilter, WhereTheSpeedIsHeldTheTurnIsFollowed) {
  const Drive drive;
  /// The turn that is predicted after the last of the sweeps of which next to nothing fits, each turned by so much.
  const auto predictedTurn = [&](const std::vector<double>& turns_rad) {
    PoseFilter filter = makeFilter();
    driveMeasured(filter, drive, 20);
    int sweep = 20;
    SweepPrediction prediction;
    for (int i = 0; i < 5; ++i) {
      EXPECT_TRUE(filter.predict(drive.stamp(++sweep), prediction));
      correctByBoth(filter, measured(drive.at(sweep)), 0.9);
    }
    double yaw_rad = 0.0;
    for (const double turn_rad : turns_rad) {
      EXPECT_TRUE(filter.predict(drive.stamp(++sweep), prediction));
      yaw_rad += turn_rad;
      Pose T = prediction.T_odom_cog * pose(0.05, 0, 0, 0, 0, 0);
      T.linear() = rotationFromRpy(0.0, 0.0, yaw_rad);
      correctByBoth(filter, measured(T), 0.1);
    }
    EXPECT_TRUE(filter.predict(drive.stamp(++sweep), prediction));
    const Pose T_previous_next = prediction.T_previous_now();
    EXPECT_NEAR(T_previous_next.translation().head<2>().norm(), 1.4, 0.1) << "the speed is held";
    return rpyFromRotation(T_previous_next.linear()).z();
  };
  const double curvature_rad = 0.02;
  EXPECT_NEAR(predictedTurn(std::vector<double>(9, curvature_rad)), curvature_rad, 0.3 * curvature_rad);
  EXPECT_LT(predictedTurn({0.0, 0.0, 3.0 * kDegree}), 1.3 * kDegree) << "one odd heading is no yaw rate";
}

TEST(PoseFilter, ATurnThatNoVehicleMakesMayBeWrongByARatio) {
  const auto turning = [](double turn_deg) {
    return addedVariances([=](int sweep, const Pose& T) {
      return measured(sweep < 31 ? T : T * pose(0, 0, 0, 0, turn_deg * kDegree, 0));
    });
  };
  EXPECT_NEAR(std::sqrt(turning(6.0)[2]), 0.6 * kDegree, 0.1 * kDegree);
  EXPECT_EQ(turning(1.0).norm(), 0.0) << "a bump in the road";
}

TEST(PoseFilter, ATurnIsNotHeldAgainstAPredictionThatCouldNotKnow) {
  const Drive drive;
  const auto yawVarianceAfter = [&](int sweep, bool clock_jump_suspected, const PoseFilter::Params& params) {
    PoseFilter filter = makeFilter(params);
    driveMeasured(filter, drive, 20);
    Measurement turned = measured(drive.at(sweep) * pose(0, 0, 0, 0, 6.0 * kDegree, 0));
    turned.clock_jump_suspected = clock_jump_suspected;
    const FilterState state = step(filter, drive.stamp(sweep), {turned, turned}).state;
    EXPECT_TRUE(state.measurement_applied);
    return state.increment_covariance(5, 5);
  };
  const auto added = [&](int sweep, bool clock_jump_suspected) {
    return yawVarianceAfter(sweep, clock_jump_suspected, {}) -
           yawVarianceAfter(sweep, clock_jump_suspected, believingAll());
  };
  EXPECT_GT(added(21, false), std::pow(0.5 * kDegree, 2));
  EXPECT_EQ(added(21, true), 0.0) << "it went by another interval";
  EXPECT_EQ(added(25, false), 0.0) << "a long one";
}

TEST(PoseFilter, WhatIsNotBelievedConfirmsNothingUntilAPoseIsSet) {
  const Drive drive;
  PoseFilter filter = makeFilter();
  driveMeasured(filter, drive, 20);
  const auto driven = [&](int sweep, double share) {
    Measurement measurement = measured(filter.state().T_odom_cog * drive.at(1));
    measurement.inlier_ratio = share;
    SweepPrediction prediction;
    EXPECT_TRUE(filter.predict(drive.stamp(sweep), prediction));
    return filter.correct({{kIcpPointToPoint, &measurement}, {kIcpPointToPlane, &measurement}});
  };
  for (int i = 21; i <= 23; ++i) EXPECT_EQ(driven(i, 0.9).fusion.confirmed, true);
  for (int i = 24; i <= 26; ++i) driven(i, 0.1);
  const FilterState doubtful = driven(27, 0.1);
  EXPECT_FALSE(doubtful.fusion.confirmed);
  ASSERT_TRUE(filter.setPose(drive.at(0)));
  const FilterState anew = driven(28, 0.1);
  EXPECT_TRUE(anew.fusion.confirmed);
  EXPECT_LT(anew.increment_covariance(0, 0), 0.1 * doubtful.increment_covariance(0, 0));
}

/// Over a gap a measurement counts only if another confirms it.
TEST(PoseFilter, OutvotedDoesNotPreventConfirmation) {
  const Drive drive;
  constexpr int kAfterGap = 25;
  const Pose T = drive.at(kAfterGap);
  const auto moved = [&](double y_m) { return measured(Pose(Eigen::Translation3d(0.0, y_m, 0.0)) * T); };
  const auto incrementWith = [&](const std::vector<Measurement>& measurements) {
    PoseFilter filter = makeFilter();
    driveMeasured(filter, drive, 20);
    return incrementOf(step(filter, drive.stamp(kAfterGap), measurements).state);
  };
  const OdometryIncrement alone = incrementWith({moved(0.0)});
  EXPECT_FALSE(alone.registration);
  EXPECT_FALSE(alone.confirmed);
  const OdometryIncrement one_against_one = incrementWith({moved(0.0), moved(10.0)});
  EXPECT_FALSE(one_against_one.registration);
  EXPECT_FALSE(one_against_one.confirmed);
  const OdometryIncrement two_against_one = incrementWith({moved(0.0), moved(0.05), moved(10.0)});
  ASSERT_TRUE(two_against_one.registration);
  EXPECT_TRUE(two_against_one.confirmed);
  EXPECT_LT((*two_against_one.registration)(1, 1), 0.02 * 0.02);
}

TEST(PoseFilter, ResetStartsAnew) {
  PoseFilter used = makeFilter(), fresh = makeFilter();
  Drive drive;
  drive.yaw_rate_rps = 0.3;
  driveMeasured(used, drive, 20);
  used.reset(drive.T_start);
  EXPECT_TRUE(used.state().T_odom_cog.isApprox(drive.T_start));
  EXPECT_FALSE(used.state().measurement_applied);
  const Step a = driveMeasured(used, drive, 12);  // earlier stamps are taken again
  const Step b = driveMeasured(fresh, drive, 12);
  EXPECT_TRUE((a.state.T_odom_cog.matrix().array() == b.state.T_odom_cog.matrix().array()).all());
  EXPECT_TRUE((a.state.covariance.array() == b.state.covariance.array()).all());
  EXPECT_TRUE((a.prediction.T_odom_cog.matrix().array() == b.prediction.T_odom_cog.matrix().array()).all());
}

TEST(PoseFilter, ParametersAreChecked) {
  const auto refused = [](const std::function<void(PoseFilter::Params&)>& change) {
    PoseFilter::Params params;
    change(params);
    return errorOf([&] { validate(params); });
  };
  EXPECT_EQ(refused([](PoseFilter::Params&) {}), "no error");
  EXPECT_NE(refused([](PoseFilter::Params& p) { p.increment_scale = -1.0; }).find("increment_scale"),
            std::string::npos);
}

/// The same curve in another odom; only sweep `set_at` says so, by setPose().
TEST(PoseFilter, SetPoseMovesOdomOnly) {
  Drive drive;
  drive.yaw_rate_rps = 0.2;
  drive.T_start = pose(1.0, 2.0, 0.5, 0.01, -0.03, 0.4);
  const Pose T_new_old = pose(100.0, -50.0, 7.0, 0.0, 0.0, 2.6);
  constexpr int kSetAt = 12, kLast = 20;
  PoseFilter undisturbed = makeFilter(), filter = makeFilter();
  const Step before = driveMeasured(filter, drive, kSetAt);
  driveMeasured(undisturbed, drive, kSetAt);
  EXPECT_FALSE(filter.setPose(pose(kNan, 0, 0, 0, 0, 0)));
  EXPECT_EQ(filter.state().odom_reset_count, 0);
  ASSERT_TRUE(filter.setPose(T_new_old * before.state.T_odom_cog));
  EXPECT_EQ(filter.state().odom_reset_count, 1);
  EXPECT_LT(distance(filter.state().T_odom_cog, T_new_old * before.state.T_odom_cog), 1e-9);
  EXPECT_LT(distance(filter.state().T_previous_now, before.state.T_previous_now), 1e-12) << "the true motion";
  expectCovariance(filter.state().covariance, "after setPose");
  for (int i = kSetAt + 1; i <= kLast; ++i) {
    const Step expected = step(undisturbed, drive.stamp(i), {measured(drive.at(i))});
    const Step moved = step(filter, drive.stamp(i), {measured(T_new_old * drive.at(i))});
    EXPECT_EQ(moved.prediction.odom_reset_count, 1);
    EXPECT_TRUE(moved.prediction.motionKnown());
    EXPECT_LT(distance(moved.prediction.T_odom_cog, T_new_old * expected.prediction.T_odom_cog), 1e-6) << i;
    EXPECT_LT(angle(moved.prediction.T_odom_cog, T_new_old * expected.prediction.T_odom_cog), 1e-7) << i;
    EXPECT_LT(distance(moved.state.T_odom_cog, T_new_old * expected.state.T_odom_cog), 1e-6) << i;
    EXPECT_NEAR(moved.state.sigma_yaw_rad, expected.state.sigma_yaw_rad, 1e-8) << i;
    EXPECT_NEAR(moved.state.covariance.diagonal().head(2).sum(), expected.state.covariance.diagonal().head(2).sum(),
                1e-8)
        << i;
    EXPECT_LT((moved.state.increment_covariance - expected.state.increment_covariance).cwiseAbs().maxCoeff(), 1e-8)
        << i;
  }
}

TEST(PoseFilter, TheFusionsRulesCanChangeInFlight) {
  PoseFilter filter = makeFilter();
  Drive drive;
  driveMeasured(filter, drive, 10);
  MeasurementFusion narrow;
  narrow.gate_sigma = 1e-6;
  filter.setFusion(narrow);
  Pose off = drive.at(11);
  off.translation().y() += 0.01;
  EXPECT_TRUE(step(filter, drive.stamp(11), {measured(off)}).state.fusion.all_gated_out);
}

const Measurement kNothingThere;  // to register against: kNoReference

TEST(PoseFilterReference, TakesInWhatIsMeasuredInAllRotations) {
  const Drive drive;
  PoseFilter filter = makeFilter();
  EXPECT_TRUE(driveMeasured(filter, drive, 5).state.inMap());
  Matrix6d from_above = diagonal(0.01, 1e-3);
  from_above(3, 3) = from_above(4, 4) = 1.0;
  const FilterState above = step(filter, drive.stamp(6), {measured(drive.at(6), from_above)}).state;
  EXPECT_TRUE(above.measurement_applied);
  EXPECT_FALSE(above.inMap()) << "the map would tilt by what roll and pitch are off";
  const FilterState predicted = step(filter, drive.stamp(7), {}).state;
  EXPECT_FALSE(predicted.measurement_applied || predicted.inMap());
  EXPECT_TRUE(step(filter, drive.stamp(8), {measured(drive.at(8))}).state.inMap());
  EXPECT_TRUE(step(filter, drive.stamp(9), {measured(drive.at(9)), measured(drive.at(9), from_above)}).state.inMap());
}

FilterState stepOfBoth(PoseFilter& filter, double stamp_s, const Measurement& measurement, double inlier_ratio = 1.0) {
  SweepPrediction prediction;
  EXPECT_TRUE(filter.predict(stamp_s, prediction));
  return correctByBoth(filter, measurement, inlier_ratio);
}

TEST(PoseFilterReference, NothingFitsForASecondRestarts) {
  const Drive drive;
  PoseFilter filter = makeFilter();
  driveMeasured(filter, drive, 5);
  int sweep = 6;
  for (; sweep < 12; ++sweep) stepOfBoth(filter, drive.stamp(sweep), measured(drive.at(sweep)));
  for (int i = 1; i < 10; ++i, ++sweep) {
    EXPECT_NE(stepOfBoth(filter, drive.stamp(sweep), measured(drive.at(sweep)), 0.1).map_update, MapUpdate::kRestart)
        << i;
  }
  const FilterState begun = stepOfBoth(filter, drive.stamp(sweep), measured(drive.at(sweep)), 0.1);
  EXPECT_EQ(begun.map_update, MapUpdate::kRestart);
  EXPECT_FALSE(begun.fusion.confirmed) << "it is not believed, and the speed is held";
  ++sweep;
  EXPECT_EQ(stepOfBoth(filter, drive.stamp(sweep), measured(drive.at(sweep))).map_update, MapUpdate::kInsert);
}

TEST(PoseFilterReference, IcpsWithoutReferenceRestartTheMap) {
  const Drive drive;
  PoseFilter filter = makeFilter();
  driveMeasured(filter, drive, 5);
  const FilterState begun = stepOfBoth(filter, drive.stamp(6), kNothingThere);
  EXPECT_EQ(begun.map_update, MapUpdate::kRestart);
  EXPECT_FALSE(begun.measurement_applied);
  EXPECT_EQ(incrementOf(begun).map_update, MapUpdate::kRestart);
  ASSERT_TRUE(filter.setPose(drive.at(3)));
  EXPECT_NE(stepOfBoth(filter, drive.stamp(7), kNothingThere).map_update, MapUpdate::kRestart)
      << "in another odom the references must begin anew";
}

}  // namespace
}  // namespace fail_aware::pose_filter_test
