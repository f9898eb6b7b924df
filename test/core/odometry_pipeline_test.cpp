#include "core/odometry_pipeline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "../support/street_parameters.hpp"
#include "../support/synthetic_street.hpp"
#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"
#include "core/parameters/check.hpp"
#include "simulation/random.hpp"

namespace fail_aware::odometry_pipeline_test {
namespace {

using synthetic::streetParameters;

constexpr double kPeriod_s = 0.1;
constexpr int kSweeps = 40;

std::vector<Sweep> scanDrive(const synthetic::Drive& drive, int sweeps, const synthetic::Lidar& lidar = {}) {
  const synthetic::Street street;
  std::vector<Sweep> out;
  for (int i = 0; i < sweeps; ++i) {
    out.push_back(street.scan([&](double t) { return drive.T_street_base(t); }, i * kPeriod_s,
                              static_cast<std::uint32_t>(i), lidar));
  }
  return out;
}

/// The drive that most tests share: from the first sweep on at 14 m/s in a gentle left turn.
const synthetic::Drive kDrive;
const std::vector<Sweep>& driveSweeps() {
  static const std::vector<Sweep> sweeps = scanDrive(kDrive, kSweeps);
  return sweeps;
}

SweepResult stepWith(OdometryPipeline& pipeline, Sweep sweep) { return pipeline.step(sweep); }

Sweep emptyAt(double stamp_s) {
  Sweep sweep;
  sweep.stamp_s = stamp_s;
  return sweep;
}

std::vector<SweepResult> run(OdometryPipeline& pipeline, const std::vector<Sweep>& sweeps) {
  std::vector<SweepResult> results;
  for (const Sweep& sweep : sweeps) results.push_back(stepWith(pipeline, sweep));
  return results;
}

struct PoseError {
  double horizontal_m, vertical_m, yaw_deg;
};

PoseError poseError(const Pose& T_odom_base, const Pose& truth) {
  const Pose error = truth.inverse() * T_odom_base;
  return {error.translation().head<2>().norm(), std::abs(error.translation().z()),
          std::abs(rpyFromRotation(error.linear()).z()) / kDegree};
}

void expectNear(const SweepResult& result, const Pose& truth, double tolerance_m, const std::string& what) {
  const PoseError error = poseError(result.T_odom_base, truth);
  EXPECT_LT(error.horizontal_m, tolerance_m) << what;
  EXPECT_LT(error.vertical_m, 3.0 * tolerance_m) << what;
  EXPECT_LT(error.yaw_deg, 0.2) << what;
}

bool sameBits(const Pose& a, const Pose& b) { return (a.matrix().array() == b.matrix().array()).all(); }

void expectSame(const std::vector<SweepResult>& a, const std::vector<SweepResult>& b, const std::string& what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].status, b[i].status) << what << ", sweep " << i;
    ASSERT_TRUE(sameBits(a[i].T_odom_base, b[i].T_odom_base)) << what << ", sweep " << i;
    ASSERT_TRUE((a[i].state.covariance.array() == b[i].state.covariance.array()).all()) << what << ", sweep " << i;
    const Matrix6d &of_a = a[i].of(kIcpPointToPlane).measurement.covariance,
                   &of_b = b[i].of(kIcpPointToPlane).measurement.covariance;
    ASSERT_TRUE((of_a.array() == of_b.array()).all()) << what << ", sweep " << i;
    ASSERT_EQ(a[i].monitor.eta, b[i].monitor.eta) << what << ", sweep " << i;
    ASSERT_EQ(a[i].monitor.reasons, b[i].monitor.reasons) << what << ", sweep " << i;
  }
}

PipelineParameters timedByTheField() {
  PipelineParameters params = streetParameters();
  params.sensor.timing.source = "auto";
  params.sensor.timing.stamp_reference = "auto";
  return params;
}

/// The sweep with times from its middle, which its stamp means.
Sweep timed(Sweep sweep) {
  for (const Eigen::Vector3f& p : sweep.points_lidar) {
    sweep.times_s.push_back(static_cast<float>(-0.5 * kPeriod_s * std::atan2(p.y(), p.x()) / M_PI));
  }
  return sweep;
}

/// One of the two halves of a sweep, stamped at its own middle.
Sweep halfOf(const Sweep& sweep, int half) {
  const Sweep whole = timed(sweep);
  const double middle_s = (half == 0 ? -0.25 : 0.25) * kPeriod_s;
  Sweep part;
  part.stamp_s = whole.stamp_s + middle_s;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    if ((whole.times_s[i] < 0.0f) != (half == 0)) continue;
    part.points_lidar.push_back(whole.points_lidar[i]);
    part.times_s.push_back(static_cast<float>(whole.times_s[i] - middle_s));
    if (!whole.rings.empty()) part.rings.push_back(whole.rings[i]);
  }
  return part;
}

TEST(OdometryPipeline, BothHalvesOfARevolutionJoinTheMap) {
  PipelineParameters params = timedByTheField();
  params.sensor.check.min_azimuth_coverage = 0.4;
  OdometryPipeline pipeline(params, 1);
  const Pose T_start_odom = kDrive.T_odom_base(-0.25 * kPeriod_s).inverse();
  int k = 0;
  for (const Sweep& sweep : driveSweeps()) {
    for (const int half : {0, 1}) {
      const Sweep part = halfOf(sweep, half);
      const SweepResult result = stepWith(pipeline, part);
      EXPECT_FALSE(result.condition.incomplete) << k;
      // the other half is new to the map when it first comes, and once more when the motion is known
      if (k > 3) {
        EXPECT_EQ(result.status, SweepStatus::kCorrected) << k;
        const PoseError error = poseError(result.T_odom_base, T_start_odom * kDrive.T_odom_base(part.stamp_s));
        // the first turn is found from half a sweep: 0.3 deg, and what they make in 50 m
        EXPECT_LT(error.horizontal_m, 0.25) << k;
        EXPECT_LT(error.vertical_m, 0.15) << k;
        EXPECT_LT(error.yaw_deg, 0.4) << k;
      }
      ++k;
    }
  }
}

// Its successors' field shows what its stamp means: the sweep's start, not its end.
TEST(OdometryPipeline, AFirstSweepWithoutTimesTakesItsSuccessors) {
  OdometryPipeline pipeline(timedByTheField(), 1);
  const Pose T_start_odom = kDrive.T_odom_base(-0.5 * kPeriod_s).inverse();
  for (int i = 0; i < 20; ++i) {
    Sweep sweep = timed(driveSweeps()[static_cast<std::size_t>(i)]);
    sweep.stamp_s -= 0.5 * kPeriod_s;
    for (float& time_s : sweep.times_s) time_s = i == 0 ? 0.0f : time_s + static_cast<float>(0.5 * kPeriod_s);
    const double stamp_s = sweep.stamp_s;
    const SweepResult result = stepWith(pipeline, sweep);
    EXPECT_EQ(result.timing.source, i == 0 ? TimingSource::kAzimuth : TimingSource::kField);
    EXPECT_FALSE(result.condition.time_field_refused);
    expectNear(result, T_start_odom * kDrive.T_odom_base(stamp_s), 0.15, "sweep " + std::to_string(i));
  }
}

TEST(OdometryPipeline, ARefusedTimeFieldIsAReason) {
  OdometryPipeline pipeline(timedByTheField(), 1);
  for (int i = 0; i < 3; ++i) {
    Sweep sweep = driveSweeps()[static_cast<std::size_t>(i)];
    sweep.time_field.name = "clock";
    sweep.time_field.refused = "no unit";
    const SweepResult result = stepWith(pipeline, sweep);
    EXPECT_TRUE(result.condition.time_field_refused) << i;
    EXPECT_TRUE(result.monitor.reasons & kReasonTimeFieldRefused) << i;
  }
}

TEST(OdometryPipeline, FollowsAStreetWithinCentimetres) {
  OdometryPipeline pipeline(streetParameters(), 1);
  pipeline.startRedundant();
  const std::vector<SweepResult> results = run(pipeline, driveSweeps());
  EXPECT_EQ(results[0].status, SweepStatus::kFirst);
  EXPECT_TRUE(results[0].T_odom_base.isApprox(Pose::Identity(), 1e-12)) << "odom begins at base_link";
  EXPECT_EQ(results[0].of(kIcpPointToPoint).measurement.status, MeasurementStatus::kNoReference);
  for (int i = 1; i < kSweeps; ++i) {
    const SweepResult& r = results[static_cast<std::size_t>(i)];
    EXPECT_EQ(r.status, SweepStatus::kCorrected) << i;
    EXPECT_TRUE(r.of(kIcpPointToPoint).measurement.ok() && r.of(kIcpPointToPlane).measurement.ok()) << i;
    expectNear(r, kDrive.T_odom_base(i * kPeriod_s), 0.05, "sweep " + std::to_string(i));
    EXPECT_NEAR(r.state.T_previous_now.translation().norm(), 1.4, 0.05) << i;
    EXPECT_NEAR(r.state.stamp_s, i * kPeriod_s, 1e-12);
    EXPECT_EQ(r.state.fusion.weights.size(), r.sources.size());
    EXPECT_GT(r.state.fusion.weights[1], 0.0) << i;
    EXPECT_EQ(r.monitor.time_to_failure.isKnown(), i > 1) << i << ": t1 is the first sweep whose motion is observed";
    EXPECT_EQ((r.monitor.reasons & kReasonMotionUnknown) != 0, i <= 1);
    EXPECT_GE(r.times.total_ms, 0.0);
  }
  EXPECT_LT(results.back().monitor.sigma_y_m, 1.0);
  EXPECT_GT(results.back().monitor.sigma_y_m, 0.005);
}

TEST(OdometryPipeline, SameBitsForAnyThreads) {
  const std::vector<Sweep> sweeps(driveSweeps().begin(), driveSweeps().begin() + 8);
  OdometryPipeline one(streetParameters(), 1), two(streetParameters(), 2), again(streetParameters(), 1);
  const std::vector<SweepResult> expected = run(one, sweeps);
  expectSame(expected, run(two, sweeps), "two threads");
  expectSame(expected, run(again, sweeps), "second run");
  again.reset();
  expectSame(expected, run(again, sweeps), "after a reset");
}

TEST(OdometryPipeline, OverEmptySweepsTheModelCarriesThePose) {
  OdometryPipeline pipeline(streetParameters(), 1);
  pipeline.startRedundant();
  std::vector<Sweep> sweeps(driveSweeps().begin(), driveSweeps().begin() + 19);
  for (const std::size_t lost : {8u, 11u, 12u, 13u}) sweeps[lost] = emptyAt(sweeps[lost].stamp_s);
  const std::vector<SweepResult> results = run(pipeline, sweeps);
  for (std::size_t i = 1; i < results.size(); ++i) {
    const SweepResult& r = results[i];
    const bool lost = sweeps[i].empty();
    EXPECT_EQ(r.status, lost ? SweepStatus::kPredicted : SweepStatus::kCorrected) << i;
    EXPECT_EQ(r.state.measurement_applied, !lost) << i;
    expectNear(r, kDrive.T_odom_base(static_cast<double>(i) * kPeriod_s), lost ? 0.15 : 0.06,
               "sweep " + std::to_string(i));
    constexpr std::uint32_t kLost = kReasonSweepEmpty | kReasonNoMeasurement | kReasonPredictionOnly;
    EXPECT_EQ(r.monitor.reasons & kLost, lost ? kLost : 0u) << i;
    if (lost) {
      EXPECT_GE(static_cast<int>(r.monitor.state), static_cast<int>(FailAwareState::kDegraded)) << i;
      EXPECT_GT(r.state.covariance(0, 0), results[i - 1].state.covariance(0, 0)) << i;
    }
  }
}

TEST(OdometryPipeline, ASweepWithTooFewPointsIsLikeAnEmptyOne) {
  OdometryPipeline pipeline(streetParameters(), 1);
  std::vector<Sweep> sweeps(driveSweeps().begin(), driveSweeps().begin() + 9);
  sweeps[5].points_lidar.resize(100);
  sweeps[5].intensities.resize(100);
  sweeps[5].rings.resize(100);
  const std::vector<SweepResult> results = run(pipeline, sweeps);
  EXPECT_EQ(results[5].status, SweepStatus::kPredicted);
  EXPECT_EQ(results[6].status, SweepStatus::kCorrected);
  expectNear(results[8], kDrive.T_odom_base(0.8), 0.05, "after it");
}

/// The live graph leaves a measurement that is switched off out of the fusion, too.
TEST(OdometryPipeline, UnusedIcpDoesNotBeginTheDrive) {
  PipelineParameters params = streetParameters();
  params.profile.registration.use_icp_point_to_point = false;
  OdometryPipeline pipeline(params, 1);
  std::vector<Sweep> sweeps(driveSweeps().begin(), driveSweeps().begin() + 3);
  sweeps[0] = emptyAt(sweeps[0].stamp_s);
  const std::vector<SweepResult> results = run(pipeline, sweeps);
  EXPECT_EQ(results[0].status, SweepStatus::kNotStarted);
  EXPECT_EQ(results[1].status, SweepStatus::kFirst);
  EXPECT_EQ(results[2].status, SweepStatus::kCorrected);
}

TEST(OdometryPipeline, LostFirstSweepsDoNotHideTheSpeed) {
  for (const std::vector<std::size_t>& lost : {std::vector<std::size_t>{0}, {0, 1}, {1, 2}, {2}, {0, 2, 3}}) {
    std::vector<Sweep> sweeps(driveSweeps().begin(), driveSweeps().begin() + 7);
    std::string name = "lost:";
    for (const std::size_t i : lost) {
      sweeps[i] = emptyAt(sweeps[i].stamp_s);
      name += ' ' + std::to_string(i);
    }
    OdometryPipeline pipeline(streetParameters(), 1);
    pipeline.startRedundant();
    const std::vector<SweepResult> results = run(pipeline, sweeps);
    EXPECT_EQ(results.back().status, SweepStatus::kCorrected) << name;
    const Pose increment = results[5].T_odom_base.inverse() * results[6].T_odom_base;
    EXPECT_NEAR(increment.translation().x(), 1.4, 0.03) << name;
    // until two sweeps were there nothing is known of the way; from the first of them on it is
    std::size_t first_seen = 0;
    for (; sweeps[first_seen].empty(); ++first_seen) {
      EXPECT_EQ(results[first_seen].status, SweepStatus::kNotStarted) << name;
      EXPECT_EQ(results[first_seen].monitor.t1_stamp_s, -1.0);
    }
    EXPECT_EQ(results[first_seen].status, SweepStatus::kFirst) << name;
    EXPECT_TRUE(results[first_seen].T_odom_base.isApprox(Pose::Identity(), 1e-12)) << name;
    const Pose since_seen = results[first_seen].T_odom_base.inverse() * results.back().T_odom_base;
    const Pose truth = kDrive.T_odom_base(0.6, kPeriod_s * static_cast<double>(first_seen));
    const double error_m = poseError(since_seen, truth).horizontal_m;
    if (first_seen > 0) {
      EXPECT_LT(error_m, 0.05) << name;
    } else {  // this street hardly shows the way driven in several periods, and the covariance says so
      EXPECT_LT(error_m, std::max(0.05, 2.0 * results.back().monitor.sigma_x_m)) << name;
      EXPECT_LT(error_m, 0.3) << name;
    }
  }
}

/// The drive with other stamps: its true times are known.
class WrongStamps : public testing::Test {
 protected:
  void expectSoundDrive(const std::function<double(std::size_t)>& stamp_error_s, const std::string& what) {
    OdometryPipeline pipeline(streetParameters(), 1);
    pipeline.startRedundant();
    for (std::size_t i = 0; i < driveSweeps().size(); ++i) {
      Sweep sweep = driveSweeps()[i];
      sweep.stamp_s += stamp_error_s(i);
      const double stamp_s = sweep.stamp_s;
      const SweepResult result = pipeline.step(sweep);
      const std::string where = what + ", sweep " + std::to_string(i);
      EXPECT_EQ(result.state.stamp_s, stamp_s) << where << ": what came is published";
      expectNear(result, kDrive.T_odom_base(static_cast<double>(i) * kPeriod_s), 0.06, where);
      if (i < 2) continue;
      EXPECT_LE(static_cast<int>(result.monitor.state), static_cast<int>(FailAwareState::kDegraded)) << where;
      EXPECT_NEAR(result.state.dt_s, kPeriod_s, 0.01) << where;
    }
  }
};

TEST_F(WrongStamps, JitterLeavesPosesAndStatesSound) {
  for (const double jitter_s : {0.001, 0.003}) {
    RandomStream random(3);
    expectSoundDrive([&](std::size_t) { return jitter_s * random.normal(); }, "jitter " + std::to_string(jitter_s));
  }
}

TEST_F(WrongStamps, SingleOneLeavesPosesAndStatesSound) {
  for (const double error_s : {0.025, 0.06, 0.09, -0.03, -0.08}) {
    expectSoundDrive([&](std::size_t i) { return i == 15 || i == 30 ? error_s : 0.0; }, std::to_string(error_s));
  }
}

TEST_F(WrongStamps, StepOfTheClockLeavesPosesAndStatesSound) {
  for (const double step_s : {0.04, -0.07}) {
    expectSoundDrive([&](std::size_t i) { return i >= 15 ? step_s : 0.0; }, std::to_string(step_s));
  }
}

TEST(OdometryPipeline, AStampThatDoesNotAdvanceIsRefused) {
  const std::vector<Sweep> sweeps(driveSweeps().begin(), driveSweeps().begin() + 8);
  OdometryPipeline undisturbed(streetParameters(), 1), pipeline(streetParameters(), 1);
  const std::vector<SweepResult> expected = run(undisturbed, sweeps);
  std::vector<SweepResult> results;
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    results.push_back(stepWith(pipeline, sweeps[i]));
    if (i != 5) continue;
    Sweep back = sweeps[5];
    back.stamp_s = sweeps[2].stamp_s;
    for (const Sweep& refused : {sweeps[5], back, emptyAt(sweeps[5].stamp_s)}) {
      const SweepResult r = stepWith(pipeline, refused);
      EXPECT_EQ(r.status, SweepStatus::kStampNotAdvancing);
      EXPECT_TRUE(sameBits(r.T_odom_base, results.back().T_odom_base)) << "the pose is the last one";
      EXPECT_EQ(r.state.stamp_s, sweeps[5].stamp_s);
      EXPECT_FALSE(r.of(kIcpPointToPoint).measurement.ok() || r.of(kIcpPointToPlane).measurement.ok() ||
                   r.of(kCornerSvd).measurement.ok());
    }
  }
  EXPECT_EQ(results[5].condition.dropped_before, 0);
  EXPECT_EQ(results[6].condition.dropped_before, 3) << "as live, the next sweep tells of them";
  EXPECT_NE(results[6].monitor.reasons & kReasonDroppedSweeps, 0u);
  EXPECT_EQ(results[7].condition.dropped_before, 0);
  const auto first = [](const std::vector<SweepResult>& all) {
    return std::vector<SweepResult>(all.begin(), all.begin() + 6);
  };
  expectSame(first(expected), first(results), "before");
  EXPECT_GT(results[6].state.motion_covariance(0, 0), 2.0 * expected[6].state.motion_covariance(0, 0)) << "its time";
  for (std::size_t i = 6; i < sweeps.size(); ++i) {
    EXPECT_EQ(results[i].status, expected[i].status) << i;
    EXPECT_LT((results[i].T_odom_base.translation() - expected[i].T_odom_base.translation()).norm(), 0.02) << i;
    EXPECT_LT(results[i].monitor.sigma_x_m, expected[i].monitor.sigma_x_m + 0.02) << i;
  }
}

TEST(OdometryPipeline, ARepeatedCloudCountsAsEmpty) {
  OdometryPipeline pipeline(streetParameters(), 1);
  std::vector<Sweep> sweeps(driveSweeps().begin(), driveSweeps().begin() + 8);
  sweeps[6].points_lidar = sweeps[5].points_lidar;
  const std::vector<SweepResult> results = run(pipeline, sweeps);
  EXPECT_FALSE(results[5].condition.empty);
  EXPECT_TRUE(results[6].condition.empty);
  EXPECT_NE(results[6].monitor.reasons & kReasonSweepEmpty, 0u);
  EXPECT_FALSE(results[7].condition.empty);
}

TEST(OdometryPipeline, JumpBackBeginsADrive) {
  OdometryPipeline pipeline(streetParameters(), 1);
  pipeline.startRedundant();
  std::vector<Sweep> sweeps(driveSweeps().begin(), driveSweeps().begin() + 14);
  sweeps[3].stamp_s -= 5.0;
  for (std::size_t i = 6; i < sweeps.size(); ++i) sweeps[i].stamp_s -= 5.0;
  const std::vector<SweepResult> results = run(pipeline, sweeps);
  EXPECT_EQ(results[3].status, SweepStatus::kStampNotAdvancing);
  EXPECT_EQ(results[4].status, SweepStatus::kCorrected) << "one wrong stamp: the drive goes on";
  EXPECT_EQ(results[4].condition.dropped_before, 1);
  EXPECT_EQ(results[6].status, SweepStatus::kStampNotAdvancing);
  EXPECT_EQ(results[7].status, SweepStatus::kFirst) << "the clock was set";
  EXPECT_TRUE(results[7].condition.time_jump);
  EXPECT_TRUE(results[7].T_odom_base.isApprox(results[5].T_odom_base, 1e-9));
  EXPECT_EQ(results[7].monitor.sigma_x_m, 0.0) << "t1 anew";
  for (std::size_t i = 9; i < sweeps.size(); ++i) EXPECT_EQ(results[i].status, SweepStatus::kCorrected) << i;
  EXPECT_TRUE(results[13].monitor.time_to_failure.isKnown()) << "it keeps serving";
  const Pose since = results[7].T_odom_base.inverse() * results[13].T_odom_base;
  EXPECT_LT(poseError(since, kDrive.T_odom_base(1.3, 0.7)).horizontal_m, 0.05);
}

TEST(OdometryPipeline, TwoStampsFarAheadBeginADrive) {
  OdometryPipeline pipeline(streetParameters(), 1);
  pipeline.startRedundant();
  std::vector<Sweep> sweeps(driveSweeps().begin(), driveSweeps().begin() + 14);
  sweeps[4].stamp_s += 3600.0;
  for (std::size_t i = 8; i < sweeps.size(); ++i) sweeps[i].stamp_s += 1.7e9;
  const std::vector<SweepResult> results = run(pipeline, sweeps);
  EXPECT_EQ(results[4].status, SweepStatus::kStampNotAdvancing);
  EXPECT_EQ(results[5].status, SweepStatus::kCorrected) << "the drive goes on";
  EXPECT_EQ(results[5].condition.dropped_before, 1);
  EXPECT_EQ(results[8].status, SweepStatus::kStampNotAdvancing);
  EXPECT_EQ(results[9].status, SweepStatus::kFirst) << "the clock was set";
  EXPECT_TRUE(results[9].T_odom_base.isApprox(results[7].T_odom_base, 1e-9));
  EXPECT_EQ(results[9].monitor.sigma_x_m, 0.0) << "t1 anew";
  for (std::size_t i = 11; i < sweeps.size(); ++i) EXPECT_EQ(results[i].status, SweepStatus::kCorrected) << i;
  const Pose since = results[9].T_odom_base.inverse() * results[13].T_odom_base;
  EXPECT_LT(poseError(since, kDrive.T_odom_base(1.3, 0.9)).horizontal_m, 0.05);
}

class OdometryPipelineClock : public testing::TestWithParam<double> {};  // s, by which it is set for a second

TEST_P(OdometryPipelineClock, ThatIsSetForAWhileDoesNotMoveTheCar) {
  OdometryPipeline pipeline(streetParameters(), 1);
  pipeline.startRedundant();
  std::vector<Sweep> sweeps(driveSweeps().begin(), driveSweeps().begin() + 30);
  for (std::size_t i = 10; i < 20; ++i) sweeps[i].stamp_s += GetParam();
  const std::vector<SweepResult> results = run(pipeline, sweeps);
  const std::size_t set_back = GetParam() > 0.0 ? 20 : 10, set_ahead = GetParam() > 0.0 ? 10 : 20;
  const std::size_t taken_again = set_back + static_cast<std::size_t>(std::lround(std::abs(GetParam()) / kPeriod_s));
  for (std::size_t i = 1; i < sweeps.size(); ++i) {
    const bool refused = i >= set_back && i < taken_again;
    EXPECT_EQ(results[i].status, refused ? SweepStatus::kStampNotAdvancing : SweepStatus::kCorrected) << i;
    if (!refused)
      expectNear(results[i], kDrive.T_odom_base(kPeriod_s * static_cast<double>(i)), 0.06, std::to_string(i));
  }
  for (const std::size_t i : {set_ahead, taken_again}) {
    EXPECT_TRUE(results[i].monitor.reasons & kReasonPredictionOverruled) << i;
    EXPECT_NE(results[i].monitor.state, FailAwareState::kOk) << i;
  }
}

// the last: doubles leave a difference where the stamps are the same
INSTANTIATE_TEST_SUITE_P(Set, OdometryPipelineClock, testing::Values(0.4, -0.1, -0.4, -0.4 + 1e-8));

TEST(OdometryPipeline, ClockJumpIsFoundALater) {
  OdometryPipeline pipeline(streetParameters(), 1);
  pipeline.startRedundant();
  std::vector<Sweep> sweeps(driveSweeps().begin(), driveSweeps().begin() + 20);
  for (std::size_t i = 10; i < sweeps.size(); ++i) sweeps[i].stamp_s += 5.0;
  sweeps[10].points_lidar.clear();
  const std::vector<SweepResult> results = run(pipeline, sweeps);
  EXPECT_EQ(results[10].status, SweepStatus::kPredicted);
  EXPECT_TRUE(results[11].monitor.reasons & kReasonPredictionOverruled);
  for (std::size_t i = 11; i < sweeps.size(); ++i) {
    EXPECT_EQ(results[i].status, SweepStatus::kCorrected) << i;
    expectNear(results[i], kDrive.T_odom_base(kPeriod_s * static_cast<double>(i)), 0.06, std::to_string(i));
  }
}

TEST(OdometryPipeline, AfterAResetTheNextSweepIsTheFirst) {
  OdometryPipeline pipeline(streetParameters(), 1);
  pipeline.startRedundant();
  run(pipeline, std::vector<Sweep>(driveSweeps().begin() + 20, driveSweeps().begin() + 23));
  pipeline.reset();
  const std::vector<SweepResult> results =  // stamps go back
      run(pipeline, std::vector<Sweep>(driveSweeps().begin() + 5, driveSweeps().begin() + 15));
  EXPECT_EQ(results[0].status, SweepStatus::kFirst);
  EXPECT_TRUE(results[0].T_odom_base.isApprox(Pose::Identity(), 1e-12));
  EXPECT_EQ(results[0].monitor.sigma_x_m, 0.0);
  expectNear(results[4], kDrive.T_odom_base(0.9, 0.5), 0.05, "after the reset");
  EXPECT_TRUE(results.back().monitor.time_to_failure.isKnown()) << "it keeps serving";
}

TEST(OdometryPipeline, SourcesAreThoseOfTheList) {
  OdometryPipeline pipeline(streetParameters(), 1);
  const SweepResult result = run(pipeline, {driveSweeps()[0], driveSweeps()[1]}).back();
  ASSERT_EQ(result.sources.size(), kBuiltInSources.size());
  for (std::size_t i = 0; i < kBuiltInSources.size(); ++i) {
    EXPECT_EQ(result.sources[i].name, kBuiltInSources[i].name);
    EXPECT_EQ(result.sources[i].kind, kBuiltInSources[i].kind);
  }
  for (const char* icp : {kIcpPointToPoint, kIcpPointToPlane}) {
    EXPECT_GT(result.of(icp).measurement.inliers, 0u) << icp;
    EXPECT_EQ(result.of(icp).measurement.seed_spread_m > 0.0, icp == std::string(kIcpPointToPoint)) << icp;
  }
}

TEST(OdometryPipeline, ASweepRefusedAfterAResetTellsNothingOfTheLastDrive) {
  OdometryPipeline pipeline(streetParameters(), 1);
  pipeline.startRedundant();
  const std::vector<SweepResult> before =
      run(pipeline, std::vector<Sweep>(driveSweeps().begin(), driveSweeps().begin() + 4));
  ASSERT_GT(before.back().monitor.t1_stamp_s, 0.0);
  pipeline.reset();
  Sweep unusable = driveSweeps()[5];
  unusable.stamp_s = std::numeric_limits<double>::quiet_NaN();
  const SweepResult refused = pipeline.step(unusable);
  EXPECT_EQ(refused.status, SweepStatus::kStampNotAdvancing);
  EXPECT_EQ(refused.monitor.t1_stamp_s, -1.0);
}

TEST(OdometryPipeline, AResetKeepsTheStampOfARequest) {
  OdometryPipeline pipeline(streetParameters(), 1);
  pipeline.startRedundant(driveSweeps()[6].stamp_s - 0.02);
  run(pipeline, std::vector<Sweep>(driveSweeps().begin(), driveSweeps().begin() + 2));
  pipeline.reset();
  const std::vector<SweepResult> results =
      run(pipeline, std::vector<Sweep>(driveSweeps().begin() + 2, driveSweeps().begin() + 8));
  EXPECT_EQ(results[3].monitor.t1_stamp_s, -1.0);
  EXPECT_EQ(results.back().monitor.t1_stamp_s, driveSweeps()[6].stamp_s);
}

TEST(OdometryPipeline, StampsThatStandStillAreAFailure) {
  OdometryPipeline pipeline(streetParameters(), 1);
  pipeline.startRedundant();
  std::vector<Sweep> sweeps(driveSweeps().begin(), driveSweeps().begin() + 10);
  for (std::size_t i = 5; i < 9; ++i) sweeps[i].stamp_s = sweeps[4].stamp_s;
  const std::vector<SweepResult> results = run(pipeline, sweeps);
  EXPECT_EQ(results[6].monitor.state, results[4].monitor.state);
  EXPECT_EQ(results[7].monitor.state, FailAwareState::kFailed);
  EXPECT_TRUE(results[7].monitor.reasons & kReasonStale);
  EXPECT_FALSE(results[9].monitor.reasons & kReasonStale) << "until a sweep is accepted";
}

TEST(OdometryPipeline, WhatIsStoppedSaysNothingMore) {
  OdometryPipeline pipeline(streetParameters(), 1);
  pipeline.startRedundant();
  run(pipeline, std::vector<Sweep>(driveSweeps().begin(), driveSweeps().begin() + 6));
  pipeline.stopRedundant();
  const SweepResult refused = stepWith(pipeline, driveSweeps()[5]);
  EXPECT_EQ(refused.status, SweepStatus::kStampNotAdvancing);
  EXPECT_EQ(refused.monitor.state, FailAwareState::kUnknown);
  EXPECT_EQ(refused.monitor.t1_stamp_s, -1.0);
}

TEST(OdometryPipeline, TimesToFailureAreKnownFromStartRedundantOn) {
  OdometryPipeline pipeline(streetParameters(), 1);
  for (std::size_t i = 0; i < 6; ++i) {
    if (i == 3) pipeline.startRedundant();
    const SweepResult r = stepWith(pipeline, driveSweeps()[i]);
    EXPECT_EQ(r.monitor.time_to_failure.isKnown(), i >= 3) << i;
    EXPECT_EQ(r.monitor.sigma_x_m > 0.0, i > 3) << i;
  }
}

TEST(OdometryPipeline, ServiceStartsAtAnAcceptedSweep) {
  OdometryPipeline pipeline(streetParameters(), 1);
  std::vector<Sweep> sweeps(driveSweeps().begin(), driveSweeps().begin() + 8);
  const double from_stamp_s = sweeps[4].stamp_s - 0.02;
  sweeps[2].stamp_s += 1e6;  // past t1, refused: far ahead
  sweeps[4].stamp_s = sweeps[3].stamp_s;
  pipeline.startRedundant(from_stamp_s);
  const std::vector<SweepResult> results = run(pipeline, sweeps);
  EXPECT_EQ(results[2].status, SweepStatus::kStampNotAdvancing);
  EXPECT_EQ(results[3].monitor.t1_stamp_s, -1.0);
  EXPECT_EQ(results[4].status, SweepStatus::kStampNotAdvancing);
  for (std::size_t i = 5; i < sweeps.size(); ++i) EXPECT_EQ(results[i].monitor.t1_stamp_s, sweeps[5].stamp_s) << i;
}

TEST(OdometryPipeline, AStandingVehicleStands) {
  synthetic::Drive parked;
  parked.speed_mps = 0.0;
  parked.yaw_rate_rps = 0.0;
  OdometryPipeline pipeline(streetParameters(), 1);
  for (const SweepResult& r : run(pipeline, scanDrive(parked, 5))) expectNear(r, Pose::Identity(), 0.02, "parked");
}

TEST(OdometryPipeline, SweepsThatAreCompensatedAlreadyNeedNoTiming) {
  synthetic::Lidar lidar;
  lidar.rolling_shutter = false;
  PipelineParameters params = streetParameters();
  params.sensor.timing.source = "none";
  OdometryPipeline pipeline(params, 1);
  const std::vector<SweepResult> results = run(pipeline, scanDrive(kDrive, 6, lidar));
  expectNear(results.back(), kDrive.T_odom_base(0.5), 0.05, "without timing");
}

// A head whose zero is off, and whose clouds begin at its own rear. Compensated clouds are timed by it, too.
TEST(OdometryPipeline, AzimuthOffsetIsCorrected) {
  constexpr double kOff_deg = -6.0;
  const Eigen::Matrix3f turn = rotationFromRpy(0.0, 0.0, kOff_deg * kDegree).cast<float>();
  for (const std::string source : {"azimuth", "none"}) {
    PipelineParameters params = streetParameters();
    params.sensor.timing.source = source;
    // Turned points are rounded otherwise. A seed of the point-to-point ICP that then ends elsewhere moves its mean by
    // 7 mm.
    params.profile.registration.use_icp_point_to_point = false;
    params.profile.vertical_reference.enabled = false;  // the rounding decides which points of a wall it takes, too
    std::vector<Sweep> sweeps(driveSweeps().begin(), driveSweeps().begin() + 8);
    OdometryPipeline straight(params, 1);
    const std::vector<SweepResult> expected = run(straight, sweeps);
    for (Sweep& sweep : sweeps) {
      for (Eigen::Vector3f& p : sweep.points_lidar) p = (turn * p).eval();
    }
    params.sensor.azimuth.angle_deg = -kOff_deg;
    params.sensor.timing.start_azimuth_deg = 180.0 + kOff_deg;
    OdometryPipeline corrected(params, 1);
    const std::vector<SweepResult> results = run(corrected, sweeps);
    for (std::size_t i = 0; i < results.size(); ++i) {
      expectNear(results[i], expected[i].T_odom_base, 1e-4, source + " " + std::to_string(i));
    }
  }
}

TEST(OdometryPipeline, MeasurementsCanBeLeftOut) {
  const std::vector<Sweep> sweeps(driveSweeps().begin(), driveSweeps().begin() + 5);
  const auto lastWith = [&](bool point, bool plane, bool corners) {
    PipelineParameters params = streetParameters();
    params.profile.registration.use_icp_point_to_point = point;
    params.profile.registration.use_icp_point_to_plane = plane;
    params.profile.registration.use_corner_svd = corners;
    OdometryPipeline pipeline(params, 2);
    return run(pipeline, sweeps).back();
  };
  const SweepResult plane = lastWith(false, true, false);
  EXPECT_EQ(plane.status, SweepStatus::kCorrected);
  EXPECT_FALSE(plane.of(kIcpPointToPoint).measurement.ok() || plane.of(kCornerSvd).measurement.ok());
  EXPECT_EQ(plane.state.fusion.weights[0], 0.0);
  EXPECT_EQ(plane.monitor.reasons & (kReasonMissingIcpPoint | kReasonMissingCorners), 0u)
      << "not asked for, not missed";
  const SweepResult point = lastWith(true, false, true);
  EXPECT_EQ(point.status, SweepStatus::kCorrected);
  EXPECT_FALSE(point.of(kIcpPointToPlane).measurement.ok());
  EXPECT_EQ(point.monitor.reasons & kReasonMissingIcpPlane, 0u);
}

TEST(OdometryPipeline, ParametersAreChecked) {
  EXPECT_THROW(OdometryPipeline(streetParameters(), 0), ParameterError);
  EXPECT_THROW(OdometryPipeline(streetParameters(), 257), ParameterError);
  PipelineParameters params = streetParameters();
  params.profile.registration.reference.voxels.voxel_size_m = -1.0;
  try {
    OdometryPipeline pipeline(params, 1);
    FAIL();
  } catch (const ParameterError& error) {
    EXPECT_EQ(std::string(error.what()).rfind("registration.reference.voxels.voxel_size_m = -1", 0), 0u)
        << error.what();
  }
}

}  // namespace
}  // namespace fail_aware::odometry_pipeline_test
