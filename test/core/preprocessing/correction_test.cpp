#include "core/preprocessing/correction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../../support/poses.hpp"
#include "core/geometry/degree.hpp"
#include "core/preprocessing/timing.hpp"

namespace fail_aware::correction_test {
namespace {

constexpr double kPeriod_s = 0.1;

/// A drive with constant twist of the centre of gravity, in a hall of 60 m x 40 m x 6 m, with a lidar off the centre.
struct Drive {
  Vector6d twist_cog = vector6(14.0, 0.4, -0.1, 0.05, -0.08, 0.5);
  Pose T_cog_lidar = poseFromVector(vector6(0.9, -0.2, 1.2, 0.02, 0.03, -0.1));
  Pose T_odom_cog_0 = poseFromVector(vector6(3.0, -2.0, 0.5, 0.01, -0.02, 0.3));

  Pose cogAt(double t) const { return T_odom_cog_0 * expSe3(t * twist_cog); }
  Pose lidarAt(double t) const { return cogAt(t) * T_cog_lidar; }
};

Eigen::Vector3d hitHall(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d low(-30.0, -20.0, -1.0), high(30.0, 20.0, 5.0);
  double nearest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    if (direction[k] > 0.0) nearest = std::min(nearest, (high[k] - from[k]) / direction[k]);
    if (direction[k] < 0.0) nearest = std::min(nearest, (low[k] - from[k]) / direction[k]);
  }
  return from + nearest * direction;
}

struct MovingSweep {
  Sweep sweep;
  std::vector<double> times_from_start_s;
  std::vector<Eigen::Vector3d> truth_lidar;  ///< in the lidar frame at the stamp
};

/// The sweep whose stamp is `stamp_s`, at `stamp_position` of its period, as the moving lidar sees it.
MovingSweep scan(const Drive& drive, double stamp_s, double stamp_position, bool clockwise, double start_azimuth_rad) {
  MovingSweep out;
  out.sweep.stamp_s = stamp_s;
  const Pose T_lidar_odom = drive.lidarAt(stamp_s).inverse();
  const int columns = 360;
  for (int j = 0; j < columns; ++j) {
    const double fraction = (j + 0.5) / columns;
    const double yaw = start_azimuth_rad + (clockwise ? -1.0 : 1.0) * 2.0 * M_PI * fraction;
    const Pose T_odom_lidar = drive.lidarAt(stamp_s + (fraction - stamp_position) * kPeriod_s);
    for (double elevation = -0.4; elevation < 0.2; elevation += 0.11) {
      const Eigen::Vector3d beam(std::cos(elevation) * std::cos(yaw), std::cos(elevation) * std::sin(yaw),
                                 std::sin(elevation));
      const Eigen::Vector3d hit = hitHall(T_odom_lidar.translation(), T_odom_lidar.linear() * beam);
      out.sweep.points_lidar.push_back((T_odom_lidar.inverse() * hit).cast<float>());
      out.times_from_start_s.push_back(fraction * kPeriod_s);
      out.truth_lidar.push_back(T_lidar_odom * hit);
    }
  }
  return out;
}

double worstError(const std::vector<Eigen::Vector3f>& points, const std::vector<Eigen::Vector3d>& truth) {
  double worst = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double error = (points[i].cast<double>() - truth[i]).norm();
    if (!(error <= worst)) worst = error;
  }
  return worst;
}

struct Convention {
  const char* name;
  double position;
};
const Convention kReferences[] = {{"start", 0.0}, {"mid", 0.5}, {"end", 1.0}};

CorrectionStatus correctWithDrive(const Drive& drive, const Sweep& sweep, const std::vector<float>& times_s,
                                  CorrectedSweep& out) {
  const double dt_s = 0.1036;  // the stamps' distance need not be the sweep's period
  return correctSweep({}, sweep, times_s, drive.cogAt(sweep.stamp_s - dt_s), drive.cogAt(sweep.stamp_s), dt_s,
                      drive.T_cog_lidar, out);
}

TEST(SweepCorrection, RestoresTheSceneFromAField) {
  const Drive drive;
  for (const Convention& reference : kReferences) {
    MovingSweep moving = scan(drive, 0.4, reference.position, true, M_PI);
    EXPECT_GT(worstError(moving.sweep.points_lidar, moving.truth_lidar), 0.5) << "the scene must be deformed";
    for (const double zero : {0.0, 1.0}) {  // time from the first packet, from the last packet
      moving.sweep.times_s.clear();
      for (const double t : moving.times_from_start_s) {
        moving.sweep.times_s.push_back(static_cast<float>(t - zero * kPeriod_s));
      }
      SweepTimingParams params;
      params.stamp_reference = reference.name;
      params.sweep_period_s = kPeriod_s;
      std::vector<float> times_s;
      ASSERT_EQ(SweepTiming(params).assign(moving.sweep, 0.0, times_s).source, TimingSource::kField);
      CorrectedSweep out;
      ASSERT_EQ(correctWithDrive(drive, moving.sweep, times_s, out), CorrectionStatus::kCorrected);
      EXPECT_EQ(out.stamp_s, moving.sweep.stamp_s);
      EXPECT_EQ(out.times_s, times_s);
      EXPECT_LT(worstError(out.points_lidar, moving.truth_lidar), 1e-3) << reference.name << " " << zero;
    }
  }
}

TEST(SweepCorrection, RestoresTheSceneFromAzimuth) {
  const Drive drive;
  for (const Convention& reference : kReferences) {
    for (const bool clockwise : {true, false}) {
      for (const double start_deg : {180.0, 60.0}) {
        const MovingSweep moving = scan(drive, 0.4, reference.position, clockwise, start_deg * kDegree);
        SweepTimingParams params;
        params.source = "azimuth";
        params.stamp_reference = reference.name;
        params.clockwise = clockwise;
        params.start_azimuth_deg = start_deg;
        params.sweep_period_s = kPeriod_s;
        std::vector<float> times_s;
        SweepTiming(params).assign(moving.sweep, 0.0, times_s);
        CorrectedSweep out;
        correctWithDrive(drive, moving.sweep, times_s, out);
        EXPECT_LT(worstError(out.points_lidar, moving.truth_lidar), 1e-3) << reference.name << clockwise << start_deg;

        params.clockwise = !clockwise;  // the check must be able to fail
        SweepTiming(params).assign(moving.sweep, 0.0, times_s);
        correctWithDrive(drive, moving.sweep, times_s, out);
        EXPECT_GT(worstError(out.points_lidar, moving.truth_lidar), 0.1);
      }
    }
  }
}

TEST(SweepCorrection, TheLeverArmMatters) {
  const Drive drive;
  const MovingSweep moving = scan(drive, 0.4, 1.0, true, M_PI);
  std::vector<float> times_s;
  for (const double t : moving.times_from_start_s) times_s.push_back(static_cast<float>(t - kPeriod_s));
  CorrectedSweep out;
  correctSweep({}, moving.sweep, times_s, drive.cogAt(0.3), drive.cogAt(0.4), 0.1, Pose::Identity(), out);
  EXPECT_GT(worstError(out.points_lidar, moving.truth_lidar), 0.02);
}

TEST(SweepCorrection, IsAccurateFromStandstillToViolentMotion) {
  for (const double factor : {0.0, 1e-3, 1.0, 4.0, 15.0, 60.0}) {  // up to 30 rad/s, past the power series
    Drive drive;
    drive.twist_cog.tail<3>() *= factor;
    const MovingSweep moving = scan(drive, 0.01, 1.0, true, M_PI);
    std::vector<float> times_s;
    for (const double t : moving.times_from_start_s) times_s.push_back(static_cast<float>(t - kPeriod_s));
    CorrectedSweep out;
    const double dt_s = 0.02;
    correctSweep({}, moving.sweep, times_s, drive.cogAt(0.01 - dt_s), drive.cogAt(0.01), dt_s, drive.T_cog_lidar, out);
    EXPECT_LT(worstError(out.points_lidar, moving.truth_lidar), 2e-4) << factor;
  }
}

TEST(SweepCorrection, LidarTwistIsTheOneThatTakesBeginToEnd) {
  const Drive drive;
  const Vector6d twist = lidarTwist(drive.cogAt(1.0), drive.cogAt(1.25), drive.T_cog_lidar, 0.25);
  EXPECT_TRUE((drive.lidarAt(1.0) * expSe3(0.25 * twist)).isApprox(drive.lidarAt(1.25), 1e-12));
  EXPECT_NEAR(twist.tail<3>().norm(), drive.twist_cog.tail<3>().norm(), 1e-12);
}

TEST(SweepCorrection, NoTimesOrMotionChangesNothing) {
  const Drive drive;
  Sweep sweep;
  sweep.stamp_s = 7.0;
  sweep.points_lidar = {{1, 2, 3}, {-4, 5, 6}};
  const std::vector<float> times_s = {-0.1f, -0.05f};
  const Pose a = drive.cogAt(0.0), b = drive.cogAt(0.1);
  Pose broken = b;
  broken.translation().x() = std::nan("");
  Pose absurd = b;
  absurd.translation().x() = 1e6;
  Pose broken_rotation = b;
  broken_rotation.linear()(0, 1) = std::nan("");
  const float nan = std::numeric_limits<float>::quiet_NaN();
  SweepCorrectionParams disabled;
  disabled.enabled = false;

  const struct {
    CorrectionStatus expected;
    std::vector<float> times_s;
    Pose end;
    double dt_s;
    SweepCorrectionParams params;
  } cases[] = {{CorrectionStatus::kOff, {}, b, 0.1, {}},
               {CorrectionStatus::kOff, times_s, b, 0.1, disabled},
               {CorrectionStatus::kBadTimes, {0.1f}, b, 0.1, {}},
               {CorrectionStatus::kBadTimes, {0.1f, nan}, b, 0.1, {}},
               {CorrectionStatus::kNoMotion, times_s, b, 0.0, {}},
               {CorrectionStatus::kNoMotion, times_s, b, -0.1, {}},
               {CorrectionStatus::kNoMotion, times_s, b, std::nan(""), {}},
               {CorrectionStatus::kNoMotion, times_s, broken, 0.1, {}},
               {CorrectionStatus::kNoMotion, times_s, absurd, 0.1, {}},
               {CorrectionStatus::kNoMotion, times_s, broken_rotation, 0.1, {}}};
  for (const auto& c : cases) {
    CorrectedSweep out;
    out.points_lidar.resize(9);
    out.times_s.resize(9);
    const CorrectionStatus status = correctSweep(c.params, sweep, c.times_s, a, c.end, c.dt_s, drive.T_cog_lidar, out);
    EXPECT_EQ(status, c.expected) << toString(status);
    EXPECT_EQ(out.stamp_s, 7.0);
    EXPECT_EQ(out.points_lidar, sweep.points_lidar);
    EXPECT_EQ(out.times_s, c.expected == CorrectionStatus::kNoMotion ? times_s : std::vector<float>());
  }
  CorrectedSweep out;
  EXPECT_EQ(correctSweep({}, Sweep(), {}, a, b, 0.1, drive.T_cog_lidar, out), CorrectionStatus::kOff);
  EXPECT_TRUE(out.points_lidar.empty());
}

TEST(SweepCorrection, RecorrectTakesOutTheResidualMotion) {
  const Drive drive;
  const MovingSweep moving = scan(drive, 0.4, 0.5, true, M_PI);
  std::vector<float> times_s;
  for (const double t : moving.times_from_start_s) times_s.push_back(static_cast<float>(t - 0.5 * kPeriod_s));
  const Vector6d true_twist = lidarTwist(drive.cogAt(0.3), drive.cogAt(0.4), drive.T_cog_lidar, 0.1);
  const Vector6d error = vector6(1.0, 0.2, 0.1, 0.01, -0.02, 0.02);
  const Pose begin = drive.cogAt(0.3);
  const Pose end = begin * drive.T_cog_lidar * expSe3(0.1 * (true_twist - error)) * drive.T_cog_lidar.inverse();

  CorrectedSweep out;
  ASSERT_EQ(correctSweep({}, moving.sweep, times_s, begin, end, 0.1, drive.T_cog_lidar, out),
            CorrectionStatus::kCorrected);
  const Vector6d twist_used = lidarTwist(begin, end, drive.T_cog_lidar, 0.1);
  EXPECT_GT(worstError(out.points_lidar, moving.truth_lidar), 0.04);

  std::vector<Eigen::Vector3f> first_order = out.points_lidar;
  ASSERT_TRUE(redeskewBy(first_order, times_s, true_twist - twist_used));
  EXPECT_LT(worstError(first_order, moving.truth_lidar), 1.5e-3);

  std::vector<Eigen::Vector3f> exact = out.points_lidar;
  ASSERT_TRUE(redeskewBy(exact, times_s, -twist_used));
  EXPECT_LT((exact[100] - moving.sweep.points_lidar[100]).norm(), 1e-4f);
  ASSERT_TRUE(redeskewBy(exact, times_s, true_twist));
  EXPECT_LT(worstError(exact, moving.truth_lidar), 2e-4);
}

TEST(SweepCorrection, RecorrectMakesUpForACorrectionWithoutMotion) {
  const Drive drive;
  const MovingSweep moving = scan(drive, 0.4, 1.0, true, M_PI);
  std::vector<float> times_s;
  for (const double t : moving.times_from_start_s) times_s.push_back(static_cast<float>(t - kPeriod_s));
  CorrectedSweep out;
  correctSweep({}, moving.sweep, times_s, Pose::Identity(), Pose::Identity(), 0.0, drive.T_cog_lidar, out);
  ASSERT_TRUE(redeskewBy(out.points_lidar, out.times_s,
                         lidarTwist(drive.cogAt(0.3), drive.cogAt(0.4), drive.T_cog_lidar, 0.1)));
  EXPECT_LT(worstError(out.points_lidar, moving.truth_lidar), 1e-3);
}

TEST(SweepCorrection, RecorrectRefusesWhatItCannotUse) {
  std::vector<Eigen::Vector3f> points = {{1, 2, 3}, {4, 5, 6}};
  const std::vector<Eigen::Vector3f> before = points;
  const Vector6d twist = vector6(1, 0, 0, 0, 0, 0.1);
  Vector6d broken = twist;
  broken[4] = std::nan("");
  EXPECT_FALSE(redeskewBy(points, {}, twist));
  EXPECT_FALSE(redeskewBy(points, {0.1f}, twist));
  EXPECT_FALSE(redeskewBy(points, {0.1f, std::numeric_limits<float>::infinity()}, twist));
  EXPECT_FALSE(redeskewBy(points, {0.1f, 0.2f}, broken));
  EXPECT_EQ(points, before);
}

}  // namespace
}  // namespace fail_aware::correction_test
