#include "core/aiding/road_profile_odometry.hpp"

#include <gtest/gtest.h>

#include <optional>

#include "../../support/synthetic_tunnel.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::road_profile_odometry_test {
namespace {

using synthetic::Tunnel;

CorrectedSweep uncorrected(const Sweep& sweep) {
  CorrectedSweep corrected;
  corrected.stamp_s = sweep.stamp_s;
  corrected.points_lidar = sweep.points_lidar;
  for (const float t : sweep.times_s) corrected.times_s.push_back(t - 0.05f);
  return corrected;
}

// The lidar straight above the vehicle's centre.
Pose T_cog_lidar() {
  Pose T = Pose::Identity();
  T.translation() = Eigen::Vector3d(-0.6, 0.0, 1.2);
  return T;
}

// Sweeps corrected for standstill: nothing is known of the speed.
std::optional<RoadProfileOdometry::Speed> drive(RoadProfileOdometry& relief, const Tunnel& tunnel, double speed_mps,
                                                int sweeps) {
  std::optional<RoadProfileOdometry::Speed> speed;
  for (int k = 0; k < sweeps; ++k) {
    relief.add(uncorrected(tunnel.scan(100.0, speed_mps, 0.1 * k, static_cast<std::uint32_t>(k))), T_cog_lidar(),
               Vector6d::Zero(), 0.0);
    speed = relief.findSpeed();
  }
  return speed;
}

TEST(RoadProfileOdometry, FindsSpeedBehindACar) {
  for (const double speed_mps : {6.0, 13.0, 24.0, -4.0}) {
    Tunnel tunnel;
    tunnel.profile_m = 0.006;
    RoadProfileOdometry relief{RoadProfileOdometry::Params()};
    const std::optional<RoadProfileOdometry::Speed> speed = drive(relief, tunnel, speed_mps, 20);
    ASSERT_TRUE(speed.has_value()) << speed_mps;
    EXPECT_NEAR(speed->speed_mps, speed_mps, 0.4);
    EXPECT_GT(speed->sigma_mps, 0.0);
  }
}

TEST(RoadProfileOdometry, FindsNothingOnAnEvenRoad) {
  RoadProfileOdometry relief{RoadProfileOdometry::Params()};
  const Tunnel tunnel;
  for (int k = 0; k < 25; ++k) {
    relief.add(uncorrected(tunnel.scan(100.0, 13.0, 0.1 * k, static_cast<std::uint32_t>(k))), T_cog_lidar(),
               Vector6d::Zero(), 0.0);
    EXPECT_FALSE(relief.findSpeed().has_value()) << k;
  }
}

TEST(RoadProfileOdometry, SaysNothingOfAVehicleThatStands) {
  Tunnel tunnel;
  tunnel.profile_m = 0.006;
  RoadProfileOdometry relief{RoadProfileOdometry::Params()};
  EXPECT_FALSE(drive(relief, tunnel, 0.0, 20).has_value()) << "the relief is part of the mean";
}

TEST(RoadProfileOdometry, ASpeedThatTheVehicleCannotHaveIsNone) {
  Tunnel tunnel;
  tunnel.profile_m = 0.006;
  RoadProfileOdometry relief{RoadProfileOdometry::Params()};
  ASSERT_TRUE(drive(relief, tunnel, 13.0, 20).has_value());
  EXPECT_TRUE(relief.findSpeed(12.0, 0.5).has_value());
  EXPECT_FALSE(relief.findSpeed(5.0, 0.5).has_value());
  EXPECT_FALSE(relief.hasSpeed());
}

/// At a walking pace the opposite motion fits nearly as well: such a result has a sigma of metres a second.
TEST(RoadProfileOdometry, ImpossibleSpeedIsRejected) {
  Tunnel tunnel;
  tunnel.profile_m = 0.006;
  for (const double speed_mps : {0.2, 0.4}) {
    RoadProfileOdometry relief{RoadProfileOdometry::Params()};
    const std::optional<RoadProfileOdometry::Speed> speed = drive(relief, tunnel, speed_mps, 20);
    ASSERT_TRUE(speed.has_value()) << speed_mps;
    ASSERT_GT(speed->sigma_mps, 4.0) << speed_mps;
    EXPECT_TRUE(relief.findSpeed(1.0, 0.5).has_value()) << speed_mps;
    EXPECT_FALSE(relief.findSpeed(14.0, 2.0).has_value()) << speed_mps;
  }
}

TEST(RoadProfileOdometry, WaitsForEnoughSweepsAndForgetsOldOnes) {
  Tunnel tunnel;
  tunnel.profile_m = 0.006;
  RoadProfileOdometry::Params params;
  RoadProfileOdometry relief(params);
  EXPECT_FALSE(drive(relief, tunnel, 13.0, params.min_sweeps - 1).has_value());
  EXPECT_EQ(relief.sweeps(), static_cast<std::size_t>(params.min_sweeps - 1));
  relief.clear();
  EXPECT_EQ(relief.sweeps(), 0u);
  drive(relief, tunnel, 13.0, params.window_sweeps + 3);
  EXPECT_EQ(relief.sweeps(), static_cast<std::size_t>(params.window_sweeps));
}

TEST(RoadProfileOdometry, AfterAGapItStartsAnew) {
  Tunnel tunnel;
  tunnel.profile_m = 0.006;
  RoadProfileOdometry relief{RoadProfileOdometry::Params()};
  ASSERT_TRUE(drive(relief, tunnel, 13.0, 20).has_value());
  for (const double gap_s : {0.9, 1.2}) {
    relief.clear();
    drive(relief, tunnel, 13.0, 20);
    relief.add(uncorrected(tunnel.scan(100.0, 13.0, 1.9 + gap_s, 20)), T_cog_lidar(), Vector6d::Zero(), 0.0);
    EXPECT_EQ(relief.findSpeed().has_value(), gap_s < 1.0) << gap_s;
  }
}

TEST(RoadProfileOdometry, WithoutARoadItStartsAnew) {
  Tunnel tunnel;
  tunnel.profile_m = 0.006;
  RoadProfileOdometry relief{RoadProfileOdometry::Params()};
  drive(relief, tunnel, 13.0, 5);
  relief.add(CorrectedSweep(), T_cog_lidar(), Vector6d::Zero(), 0.0);
  EXPECT_EQ(relief.sweeps(), 0u);
  EXPECT_FALSE(relief.findSpeed().has_value());
}

TEST(RoadProfileOdometry, CanBeSwitchedOff) {
  Tunnel tunnel;
  tunnel.profile_m = 0.006;
  RoadProfileOdometry::Params params;
  params.enabled = false;
  RoadProfileOdometry relief(params);
  EXPECT_FALSE(drive(relief, tunnel, 13.0, 12).has_value());
}

TEST(RoadProfileOdometry, ParametersAreChecked) {
  RoadProfileOdometry::Params params;
  params.max_speed_mps = params.min_speed_mps - 1.0;
  EXPECT_THROW(validate(params), ParameterError);
}

}  // namespace
}  // namespace fail_aware::road_profile_odometry_test
