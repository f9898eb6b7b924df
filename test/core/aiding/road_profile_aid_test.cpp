#include "core/aiding/road_profile_aid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "../../support/synthetic_tunnel.hpp"

namespace fail_aware::road_profile_aid_test {
namespace {

using synthetic::Tunnel;

/// What one sweep at base_link's position x_m tells, deskewed for `assumed_mps`.
RoadProfileAid::Result add(RoadProfileAid& aid, int k, double x_m, double speed_mps, double assumed_mps,
                           const EstimateTrack& track, SweepPrediction prediction = {}) {
  prediction.dt_s = 0.1;
  Tunnel tunnel;
  tunnel.profile_m = 0.006;
  const double time_s = 0.1 * k;
  const Sweep seen = tunnel.scan(x_m - speed_mps * time_s, speed_mps, time_s, static_cast<std::uint32_t>(k));
  CorrectedSweep sweep;
  sweep.stamp_s = seen.stamp_s;
  sweep.points_lidar = seen.points_lidar;
  for (const float since_start_s : seen.times_s) sweep.times_s.push_back(since_start_s - 0.05f);
  RegistrationScan scan;
  scan.cloud.map_points_cog = sweep.points_lidar;
  scan.T_cog_lidar.translation() = Eigen::Vector3d(-0.6, 0.0, 1.2);
  scan.twist_cog[0] = assumed_mps;
  scan.usable = true;
  return aid.find(sweep, scan, prediction, track);
}

/// 21 sweeps of an uneven road at 13 m/s, deskewed for standstill; what the last one tells.
RoadProfileAid::Result drivenThroughTunnel(const EstimateTrack& track) {
  RoadProfileAid aid{RoadProfileOdometry::Params()};
  RoadProfileAid::Result result;
  for (int k = 0; k <= 20; ++k) {
    result = add(aid, k, 100.0 + 1.3 * k, 13.0, 0.0, track);
    if (result.map_is_wrong) return result;
  }
  return result;
}

/// Drives 2 s at 13 m/s, which the filter assumes throughout, then brakes with 3 m/s^2 for 2 s. How many of the last
/// second's sweeps tell a speed, and the least of them.
std::pair<int, double> brakesUnnoticed(MotionStatus status) {
  RoadProfileAid aid{RoadProfileOdometry::Params()};
  SweepPrediction prediction;
  prediction.motion_status = status;
  std::pair<int, double> found{0, 100.0};
  double x_m = 100.0, speed_mps = 13.0;
  for (int k = 0; k <= 40; ++k) {
    if (k > 20) speed_mps -= 0.3;
    x_m += 0.1 * speed_mps;
    const RoadProfileAid::Result result = add(aid, k, x_m, speed_mps, 13.0, EstimateTrack(), prediction);
    if (k <= 30 || !result.distance) continue;
    found = {found.first + 1, std::min(found.second, result.distance->distance_m / 0.1)};
  }
  return found;
}

TEST(RoadProfileAid, TheFirstSpeedContradictsAMapMadeAtStandstill) {
  const RoadProfileAid::Result result = drivenThroughTunnel(EstimateTrack());
  ASSERT_TRUE(result.distance);
  EXPECT_NEAR(result.distance->distance_m, 1.3, 0.04);
  EXPECT_TRUE(result.map_is_wrong);
}

TEST(RoadProfileAid, WhereTheSpeedIsObservedNothingIsLookedFor) {
  EstimateTrack track;
  FilterState observed;
  observed.measurement_applied = true;
  track.add(observed);
  EXPECT_FALSE(drivenThroughTunnel(track).distance);
}

TEST(RoadProfileAid, ASpeedThatAgreedOnceStaysNearTheFilters) {
  const auto [found, least_mps] = brakesUnnoticed(MotionStatus::kDeadReckoning);
  EXPECT_LT(found, 10);
  EXPECT_GT(least_mps, 11.0);  // 100 if none tells one
}

/// Drives at 13 m/s; the filter knows the speed. From sweep 25 on its pose is moved_m ahead, and it predicts error_m
/// ahead of that. The distances that the sweeps from 26 on tell.
std::vector<double> placesAfterAMove(double moved_m, double error_m) {
  RoadProfileAid aid{RoadProfileOdometry::Params()};
  SweepPrediction prediction;
  prediction.motion_status = MotionStatus::kDeadReckoning;
  std::vector<double> distances_m;
  for (int k = 0; k <= 30; ++k) {
    const double x_m = 1.3 * k + (k >= 25 ? moved_m : 0.0);
    prediction.T_odom_cog.translation().x() = k == 25 ? 1.3 * k : x_m + error_m;
    const RoadProfileAid::Result result = add(aid, k, 100.0 + 1.3 * k, 13.0, 13.0, EstimateTrack(), prediction);
    if (k > 25) distances_m.push_back(result.distance ? result.distance->distance_m : 0.0);
    Pose T_odom_cog = Pose::Identity();
    T_odom_cog.translation().x() = x_m;
    aid.setPose(T_odom_cog);
    prediction.T_odom_cog_previous = T_odom_cog;
  }
  return distances_m;
}

TEST(RoadProfileAid, OnceTheSpeedIsKnownThePlaceGivesTheDistance) {
  for (const double error_m : {-0.2, 0.0, 0.2}) {
    for (const double distance_m : placesAfterAMove(0.0, error_m)) EXPECT_NEAR(distance_m, 1.3, 0.1) << error_m;
  }
}

// A registration that holds again, or a pose from elsewhere, is no motion.
TEST(RoadProfileAid, DoesNotTakeACorrectionBack) {
  for (const double distance_m : placesAfterAMove(0.5, 0.0)) EXPECT_NEAR(distance_m, 1.3, 0.08);
}

TEST(RoadProfileAid, WhileTheMotionIsUnknownTheRoadDecides) {
  const auto [found, least_mps] = brakesUnnoticed(MotionStatus::kUnknown);
  EXPECT_EQ(found, 10);
  EXPECT_NEAR(least_mps, 7.1, 0.6);  // the mean of the last tenth of a second
}

TEST(RoadProfileAid, MeasuresAlongTheRoadOnly) {
  const RoadProfileAid::Distance distance{0.99, 1e-3};
  Pose T_odom_cog_start = Pose::Identity();
  T_odom_cog_start.translation() << 0.5, 0.1, 0.0;
  const Measurement measurement = roadProfileMeasurement(distance, Pose::Identity(), T_odom_cog_start);
  ASSERT_TRUE(measurement.ok());
  EXPECT_NEAR(measurement.T_odom_cog.translation().x(), 0.99, 1e-9);
  EXPECT_NEAR(measurement.T_odom_cog.translation().y(), 0.1, 1e-9);
  EXPECT_NEAR(measurement.covariance(0, 0), 1e-6, 1e-9);
  EXPECT_EQ(measurement.covariance(1, 1), kUnobservedVariance);
  EXPECT_EQ(measurement.covariance(5, 5), kUnobservedVariance);
}

TEST(RoadProfileAid, WithoutADistanceNothingIsMeasured) {
  EXPECT_FALSE(roadProfileMeasurement(std::nullopt, Pose::Identity(), Pose::Identity()).ok());
}

}  // namespace
}  // namespace fail_aware::road_profile_aid_test
