#include "core/preprocessing/sweep_corrector.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "../../support/poses.hpp"
#include "core/geometry/degree.hpp"
#include "core/pipeline_parameters.hpp"

namespace fail_aware::sweep_corrector_test {
namespace {

constexpr double kPeriod_s = 0.1;
constexpr int kPoints = 720;

const Pose kT_cog_lidar = poseFromVector(vector6(-0.8, 0.1, 1.2, 0.01, 0.02, -0.03));
const Vector6d kTwistCog = vector6(14.0, 0.2, 0.0, 0.0, 0.0, 0.4);

Pose cogAt(double stamp_s) { return expSe3(stamp_s * kTwistCog); }

SweepTimingParams timingParams(const std::string& stamp_reference = "mid", double sweep_period_s = kPeriod_s) {
  SweepTimingParams timing;
  timing.source = "azimuth";
  timing.stamp_reference = stamp_reference;
  timing.sweep_period_s = sweep_period_s;
  return timing;
}

SweepCorrector makeCorrector(const SweepTimingParams& timing = timingParams(), double angle_deg = 0.0) {
  return SweepCorrector({angle_deg}, {}, timing, SweepCorrectionParams(), VerticalReferenceParams());
}

SweepPrediction predictionAt(double stamp_s, double dt_s) {
  SweepPrediction prediction;
  prediction.stamp_s = stamp_s;
  prediction.dt_s = dt_s;
  prediction.T_odom_cog_previous = cogAt(stamp_s - dt_s);
  prediction.T_odom_cog = cogAt(stamp_s);
  return prediction;
}

/// A clockwise sweep, begun at the rear, of points that stand in odom; `truth` is where they are seen at the stamp.
/// Each point is measured when the head points at it (its own azimuth gives its time).
struct MovingSweep {
  Sweep sweep;
  std::vector<Eigen::Vector3d> truth_lidar;
};

MovingSweep scan(double stamp_s, double stamp_position) {
  MovingSweep out;
  out.sweep.stamp_s = stamp_s;
  const Pose T_lidar_odom_at_stamp = (cogAt(stamp_s) * kT_cog_lidar).inverse();
  for (int i = 0; i < kPoints; ++i) {
    const double fraction = (i + 0.5) / kPoints;
    const double yaw = M_PI - 2.0 * M_PI * fraction;
    const double range = 20.0 + 5.0 * (i % 7);
    const Eigen::Vector3d seen(range * std::cos(yaw), range * std::sin(yaw), -1.5 + 0.5 * (i % 5));
    const Pose T_odom_lidar = cogAt(stamp_s + (fraction - stamp_position) * kPeriod_s) * kT_cog_lidar;
    out.sweep.points_lidar.push_back(seen.cast<float>());
    out.truth_lidar.push_back(T_lidar_odom_at_stamp * T_odom_lidar * seen);
  }
  return out;
}

double worstError(const std::vector<Eigen::Vector3f>& points, const std::vector<Eigen::Vector3d>& truth) {
  double worst = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    worst = std::max(worst, (points[i].cast<double>() - truth[i]).norm());
  }
  return worst;
}

TEST(SweepCorrector, MovesEveryPointToTheStamp) {
  for (const auto& [reference, position] : {std::pair<const char*, double>{"start", 0.0}, {"mid", 0.5}, {"end", 1.0}}) {
    MovingSweep moving = scan(3.0, position);
    EXPECT_GT(worstError(moving.sweep.points_lidar, moving.truth_lidar), 0.5);
    CorrectedSweep corrected;
    const SweepCorrectorReport report =
        makeCorrector(timingParams(reference)).correct(moving.sweep, predictionAt(3.0, 0.107), kT_cog_lidar, corrected);
    EXPECT_TRUE(report.timing.ok());
    EXPECT_EQ(report.correction, CorrectionStatus::kCorrected);
    EXPECT_EQ(corrected.stamp_s, 3.0);
    ASSERT_EQ(corrected.points_lidar.size(), moving.truth_lidar.size());
    ASSERT_EQ(corrected.times_s.size(), moving.truth_lidar.size());
    EXPECT_NEAR(corrected.times_s.front(), -position * kPeriod_s, 1e-3);
    EXPECT_NEAR(report.middle_s, (0.5 - position) * kPeriod_s, 1e-3);
    EXPECT_LT(worstError(corrected.points_lidar, moving.truth_lidar), 2e-3) << reference;
  }
}

TEST(SweepCorrector, TheVerticalAngleIsCorrectedBeforeTheMotion) {
  const double angle_deg = 0.205, angle = angle_deg * kDegree;
  MovingSweep moving = scan(3.0, 0.5);
  for (Eigen::Vector3f& p : moving.sweep.points_lidar) {  // what a head with beams too low reports
    const double range = p.cast<double>().norm();
    const double elevation = std::asin(static_cast<double>(p.z()) / range) - angle;
    const double azimuth = std::atan2(static_cast<double>(p.y()), static_cast<double>(p.x()));
    p = (range * Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                 std::sin(elevation)))
            .cast<float>();
  }
  CorrectedSweep corrected;
  makeCorrector(timingParams(), angle_deg).correct(moving.sweep, predictionAt(3.0, 0.1), kT_cog_lidar, corrected);
  EXPECT_LT(worstError(corrected.points_lidar, moving.truth_lidar), 2e-3);
}

// The head passes its own rear, not the corrected one, when a sweep begins.
TEST(SweepCorrector, AzimuthOffsetIsCorrected) {
  SensorParameters sensor;
  sensor.azimuth.angle_deg = 8.0;
  sensor.timing = timingParams();
  MovingSweep moving = scan(3.0, 0.5);
  const Pose T_corrected_head = poseFromVector(vector6(0.0, 0.0, 0.0, 0.0, 0.0, sensor.azimuth.angle_deg * kDegree));
  // what the scan holds is of a lidar whose azimuths are right; the corrected frame is turned against it
  SweepCorrector corrector({}, sensor.azimuth, sensor.correctedTiming(), SweepCorrectionParams(),
                           VerticalReferenceParams());
  CorrectedSweep corrected;
  corrector.correct(moving.sweep, predictionAt(3.0, 0.1), kT_cog_lidar * T_corrected_head.inverse(), corrected);
  for (Eigen::Vector3d& p : moving.truth_lidar) p = T_corrected_head * p;
  EXPECT_LT(worstError(corrected.points_lidar, moving.truth_lidar), 2e-3);
  EXPECT_NEAR(corrected.times_s.front(), -0.5 * kPeriod_s, 1e-3);
}

TEST(SweepCorrector, InTheFirstSweepPointsStayAndTimesAreKept) {
  MovingSweep moving = scan(3.0, 0.5);
  CorrectedSweep corrected;
  SweepPrediction first;
  first.stamp_s = 3.0;
  const SweepCorrectorReport report = makeCorrector().correct(moving.sweep, first, kT_cog_lidar, corrected);
  EXPECT_TRUE(report.timing.ok());
  EXPECT_EQ(report.correction, CorrectionStatus::kNoMotion);
  EXPECT_EQ(report.middle_s, 0.0);
  EXPECT_EQ(corrected.points_lidar, moving.sweep.points_lidar);
  ASSERT_EQ(corrected.times_s.size(), moving.sweep.size());

  // with them the motion can still be taken out once it is known
  const Vector6d twist = lidarTwist(cogAt(0.0), cogAt(1.0), kT_cog_lidar, 1.0);
  ASSERT_TRUE(redeskewBy(corrected.points_lidar, corrected.times_s, twist));
  EXPECT_LT(worstError(corrected.points_lidar, moving.truth_lidar), 2e-3);
}

TEST(SweepCorrector, LeavesOutThePointsWithoutAUsableTime) {
  SweepTimingParams timing = timingParams();
  timing.source = "field";
  MovingSweep moving = scan(3.0, 0.5);
  Sweep& sweep = moving.sweep;
  for (int i = 0; i < kPoints; ++i) {
    sweep.times_s.push_back(static_cast<float>(kPeriod_s * ((i + 0.5) / kPoints - 0.5)));
    sweep.intensities.push_back(static_cast<float>(i));
    sweep.rings.push_back(static_cast<std::uint16_t>(i));
  }
  sweep.times_s[5] = 1e9f;
  sweep.times_s[700] = std::nanf("");
  std::vector<Eigen::Vector3d> truth;
  for (int i = 0; i < kPoints; ++i) {
    if (i != 5 && i != 700) truth.push_back(moving.truth_lidar[static_cast<std::size_t>(i)]);
  }
  CorrectedSweep corrected;
  const SweepCorrectorReport report =
      makeCorrector(timing).correct(sweep, predictionAt(3.0, 0.1), kT_cog_lidar, corrected);
  EXPECT_EQ(report.timing.outliers, 2u);
  EXPECT_EQ(report.correction, CorrectionStatus::kCorrected);
  ASSERT_EQ(corrected.points_lidar.size(), truth.size());
  EXPECT_LT(worstError(corrected.points_lidar, truth), 2e-3);
  EXPECT_EQ(sweep.size(), truth.size());
  EXPECT_EQ(corrected.times_s.size(), truth.size());
  ASSERT_EQ(sweep.intensities.size(), truth.size());
  ASSERT_EQ(corrected.rings.size(), truth.size());
  EXPECT_EQ(sweep.intensities[5], 6.0f);
  EXPECT_EQ(corrected.rings[699], 701);
  EXPECT_EQ(sweep.times_s.size(), truth.size());
}

TEST(SweepCorrector, WithoutTimingPointsStay) {
  SweepTimingParams timing = timingParams();
  timing.source = "none";  // the driver has compensated the motion already
  MovingSweep moving = scan(3.0, 0.5);
  CorrectedSweep corrected;
  const SweepCorrectorReport report =
      makeCorrector(timing).correct(moving.sweep, predictionAt(3.0, 0.1), kT_cog_lidar, corrected);
  EXPECT_FALSE(report.timing.ok());
  EXPECT_EQ(report.correction, CorrectionStatus::kOff);
  EXPECT_EQ(corrected.points_lidar, moving.sweep.points_lidar);
  EXPECT_TRUE(corrected.times_s.empty());
}

TEST(SweepCorrector, AnEmptySweepLeavesNothingOfTheOneBefore) {
  SweepCorrector corrector = makeCorrector();
  MovingSweep moving = scan(3.0, 0.5);
  CorrectedSweep corrected;
  corrector.correct(moving.sweep, predictionAt(3.0, 0.1), kT_cog_lidar, corrected);
  Sweep empty;
  empty.stamp_s = 3.1;
  const SweepCorrectorReport report = corrector.correct(empty, predictionAt(3.1, 0.1), kT_cog_lidar, corrected);
  EXPECT_FALSE(report.timing.ok());
  EXPECT_NE(report.correction, CorrectionStatus::kCorrected);
  EXPECT_TRUE(corrected.points_lidar.empty());
  EXPECT_TRUE(corrected.times_s.empty());
  EXPECT_EQ(corrected.stamp_s, 3.1);
}

TEST(SweepCorrector, TakesThePeriodThatTheSweepClockFound) {
  SweepCorrector corrector = makeCorrector(timingParams("mid", 0.0));
  for (const double period_s : {0.0, 0.05}) {
    MovingSweep moving = scan(1.0, 0.5);
    CorrectedSweep corrected;
    SweepPrediction prediction = predictionAt(1.0, 0.05);
    prediction.period_s = period_s;
    const TimingResult timing = corrector.correct(moving.sweep, prediction, kT_cog_lidar, corrected).timing;
    EXPECT_EQ(timing.period_known, period_s > 0.0);
    EXPECT_EQ(timing.period_s, period_s > 0.0 ? period_s : 0.1);
  }
}

TEST(SweepCorrector, TellsThatTheCloudsContradictTheTiming) {
  for (const bool clockwise : {true, false}) {
    SweepTimingParams timing = timingParams();
    timing.clockwise = clockwise;
    SweepCorrector corrector = makeCorrector(timing);
    for (int i = 0; i < 5; ++i) {
      Sweep sweep;
      sweep.stamp_s = 3.0 + kPeriod_s * i;
      for (const Eigen::Vector3f& point : scan(sweep.stamp_s, 0.5).sweep.points_lidar) {
        sweep.points_lidar.insert(sweep.points_lidar.end(), 3, point);  // fewer points do not show the seam
      }
      CorrectedSweep corrected;
      SweepFindings findings;
      corrector.correct(sweep, predictionAt(sweep.stamp_s, kPeriod_s), kT_cog_lidar, corrected).addTo(findings);
      EXPECT_EQ(findings.point_times_contradicted, !clockwise && i >= 2) << clockwise << i;
    }
  }
}

TEST(SweepCorrector, MissingRingsComeFromTheOrder) {
  Sweep sweep;
  std::vector<std::uint16_t> rings;
  for (std::uint16_t beam = 0; beam < 64; ++beam) {  // KITTI's order: from the highest, each counter-clockwise
    for (int deg = 0; deg < 360; ++deg) {
      const double azimuth = deg * kDegree, elevation = (2.0 - 0.4 * beam) * kDegree;
      sweep.points_lidar.push_back(
          Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), std::tan(elevation)).cast<float>() * 20.0f);
      rings.push_back(static_cast<std::uint16_t>(63 - beam));
    }
  }
  Sweep with_rings = sweep;
  with_rings.rings.assign(sweep.size(), 7);
  SweepCorrector corrector = makeCorrector();
  CorrectedSweep corrected;
  corrector.correct(sweep, SweepPrediction(), Pose::Identity(), corrected);
  EXPECT_EQ(corrected.rings, rings);
  corrector.correct(with_rings, SweepPrediction(), Pose::Identity(), corrected);
  EXPECT_EQ(corrected.rings, std::vector<std::uint16_t>(sweep.size(), 7));
}

}  // namespace
}  // namespace fail_aware::sweep_corrector_test
