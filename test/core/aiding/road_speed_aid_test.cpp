#include "core/aiding/road_speed_aid.hpp"

#include <gtest/gtest.h>

#include "../../support/synthetic_tunnel.hpp"

namespace fail_aware {
namespace {

using synthetic::Tunnel;

/// 21 sweeps of an uneven road at 13 m/s, deskewed for standstill; what the last one tells.
RoadSpeedAid::Result drivenThroughTunnel(const EstimateTrack& track) {
  Tunnel tunnel;
  tunnel.profile_m = 0.006;
  RoadSpeedAid aid{RoadProfileOdometry::Params()};
  RoadSpeedAid::Result result;
  for (int k = 0; k <= 20; ++k) {
    const Sweep seen = tunnel.scan(100.0, 13.0, 0.1 * k, static_cast<std::uint32_t>(k));
    CorrectedSweep sweep;
    sweep.stamp_s = seen.stamp_s;
    sweep.points_lidar = seen.points_lidar;
    for (const float time_s : seen.times_s) sweep.times_s.push_back(time_s - 0.05f);
    RegistrationScan scan;
    scan.cloud.map_points_cog = sweep.points_lidar;
    scan.T_cog_lidar.translation() = Eigen::Vector3d(-0.6, 0.0, 1.2);
    scan.usable = true;
    result = aid.find(sweep, scan, SweepPrediction(), track);
    if (result.map_is_wrong) return result;
  }
  return result;
}

TEST(RoadSpeedAid, TheFirstSpeedContradictsAMapMadeAtStandstill) {
  const RoadSpeedAid::Result result = drivenThroughTunnel(EstimateTrack());
  ASSERT_TRUE(result.speed);
  EXPECT_NEAR(result.speed->speed_mps, 13.0, 0.4);
  EXPECT_TRUE(result.map_is_wrong);
}

TEST(RoadSpeedAid, WhereTheSpeedIsObservedNothingIsLookedFor) {
  EstimateTrack track;
  FilterState observed;
  observed.measurement_applied = true;
  track.add(observed);
  EXPECT_FALSE(drivenThroughTunnel(track).speed);
}

TEST(RoadSpeedAid, TheDistanceComesFromTheSpeed) {
  RoadProfileOdometry::Speed speed;
  speed.speed_mps = 10.0;
  speed.acceleration_mps2 = 2.0;
  speed.sigma_mps = 0.01;
  InitialGuess guess;
  guess.dt_s = 0.1;
  guess.T_odom_cog.translation().x() = 0.5;
  const Measurement measurement = roadProfileMeasurement(speed, guess, guess.T_odom_cog);
  ASSERT_TRUE(measurement.ok());
  EXPECT_NEAR(measurement.T_odom_cog.translation().x(), 0.99, 1e-9);  // it was slower before
  EXPECT_NEAR(measurement.covariance(0, 0), 1e-6, 1e-9);
  EXPECT_EQ(measurement.covariance(1, 1), kUnobservedVariance);
  EXPECT_EQ(measurement.covariance(5, 5), kUnobservedVariance);
}

TEST(RoadSpeedAid, WithoutALastEstimateNothingIsMeasured) {
  EXPECT_FALSE(roadProfileMeasurement(RoadProfileOdometry::Speed(), InitialGuess(), Pose::Identity()).ok());
}

}  // namespace
}  // namespace fail_aware
