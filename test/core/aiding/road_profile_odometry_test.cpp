#include "core/aiding/road_profile_odometry.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

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
               Vector6d::Zero(), Pose::Identity());
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

// The edges of what is seen, and that less road is seen twice at a higher speed, must not make distances short.
TEST(RoadProfileOdometry, MeanSpeedIsTrue) {
  Tunnel tunnel;
  tunnel.profile_m = 0.006;
  RoadProfileOdometry relief{RoadProfileOdometry::Params()};
  drive(relief, tunnel, 13.0, 20);
  double sum_mps = 0.0;
  constexpr int kSweeps = 60;
  for (int k = 20; k < 20 + kSweeps; ++k) {
    relief.add(uncorrected(tunnel.scan(100.0, 13.0, 0.1 * k, static_cast<std::uint32_t>(k))), T_cog_lidar(),
               Vector6d::Zero(), Pose::Identity());
    const std::optional<RoadProfileOdometry::Speed> speed = relief.findSpeed();
    ASSERT_TRUE(speed.has_value()) << k;
    sum_mps += speed->speed_mps;
  }
  EXPECT_NEAR(sum_mps / kSweeps, 13.0, 0.01);
}

/// Where the vehicle is after `time_s`, moved by error_m.
Pose poseAt(double speed_mps, double time_s, double error_m = 0.0) {
  Pose T_odom_cog = Pose::Identity();
  T_odom_cog.translation().x() = speed_mps * time_s + error_m;
  return T_odom_cog;
}

/// Errors of the places of `sweeps` sweeps, predicted error_m ahead, among those before at their true poses.
std::vector<double> placeErrors(double profile_m, double speed_mps, double error_m, int sweeps) {
  Tunnel tunnel;
  tunnel.profile_m = profile_m;
  RoadProfileOdometry odometry{RoadProfileOdometry::Params()};
  Vector6d twist_cog = Vector6d::Zero();
  twist_cog[0] = speed_mps;
  std::vector<double> errors_m;
  for (int k = 0; k < 20 + sweeps; ++k) {
    Sweep sweep = tunnel.scan(100.0, speed_mps, 0.1 * k, static_cast<std::uint32_t>(k));
    CorrectedSweep corrected = uncorrected(sweep);
    for (std::size_t i = 0; i < corrected.points_lidar.size(); ++i) {
      corrected.points_lidar[i].x() += static_cast<float>(speed_mps) * corrected.times_s[i];
    }
    odometry.add(corrected, T_cog_lidar(), twist_cog, poseAt(speed_mps, 0.1 * k, error_m));
    if (k >= 20) {
      if (const std::optional<RoadPlace> place = odometry.findPlace(0.2)) errors_m.push_back(place->offset_m + error_m);
    }
    odometry.setPose(poseAt(speed_mps, 0.1 * k));
  }
  return errors_m;
}

TEST(RoadProfileOdometry, FindsThePlaceAmongTheSweepsBefore) {
  for (const double speed_mps : {7.0, 13.0, 24.0}) {
    for (const double error_m : {-0.3, 0.0, 0.3}) {
      const std::vector<double> errors_m = placeErrors(0.006, speed_mps, error_m, 10);
      EXPECT_EQ(errors_m.size(), 10u) << speed_mps << ' ' << error_m;
      for (const double e : errors_m) EXPECT_NEAR(e, 0.0, 0.1) << speed_mps << ' ' << error_m;
    }
  }
}

TEST(RoadProfileOdometry, NoPlaceOnAnEvenRoad) { EXPECT_LT(placeErrors(0.0, 13.0, 0.0, 20).size(), 3u); }

TEST(RoadProfileOdometry, NoPlaceAtStandstill) { EXPECT_TRUE(placeErrors(0.006, 0.0, 0.0, 10).empty()); }

// After the search for the speed, the estimates before it were wrong.
TEST(RoadProfileOdometry, APathReplacesWrongPoses) {
  Tunnel tunnel;
  tunnel.profile_m = 0.006;
  RoadProfileOdometry odometry{RoadProfileOdometry::Params()};
  const std::optional<RoadProfileOdometry::Speed> speed = drive(odometry, tunnel, 13.0, 20);
  ASSERT_TRUE(speed.has_value());
  EXPECT_FALSE(odometry.findPlace(0.2).has_value());
  odometry.setPath(*speed);
  odometry.setPose(poseAt(0.0, 0.0, 5.0));  // the path moves with the newest sweep
  odometry.add(uncorrected(tunnel.scan(100.0, 13.0, 2.0, 20)), T_cog_lidar(), Vector6d::Zero(), poseAt(13.0, 0.1, 5.2));
  const std::optional<RoadPlace> place = odometry.findPlace(0.2);
  ASSERT_TRUE(place.has_value());
  EXPECT_NEAR(place->offset_m, -0.2, 0.1);
}

TEST(RoadProfileOdometry, FindsNothingOnAnEvenRoad) {
  RoadProfileOdometry relief{RoadProfileOdometry::Params()};
  const Tunnel tunnel;
  for (int k = 0; k < 25; ++k) {
    relief.add(uncorrected(tunnel.scan(100.0, 13.0, 0.1 * k, static_cast<std::uint32_t>(k))), T_cog_lidar(),
               Vector6d::Zero(), Pose::Identity());
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
  EXPECT_TRUE(drive(relief, tunnel, 13.0, params.window_sweeps + 3).has_value());
  relief.clear();
  EXPECT_FALSE(relief.findSpeed().has_value());
  EXPECT_FALSE(drive(relief, tunnel, 13.0, params.min_sweeps - 1).has_value());
}

TEST(RoadProfileOdometry, AfterAGapItStartsAnew) {
  Tunnel tunnel;
  tunnel.profile_m = 0.006;
  RoadProfileOdometry relief{RoadProfileOdometry::Params()};
  ASSERT_TRUE(drive(relief, tunnel, 13.0, 20).has_value());
  for (const double gap_s : {0.9, 1.2}) {
    relief.clear();
    drive(relief, tunnel, 13.0, 20);
    relief.add(uncorrected(tunnel.scan(100.0, 13.0, 1.9 + gap_s, 20)), T_cog_lidar(), Vector6d::Zero(),
               Pose::Identity());
    EXPECT_EQ(relief.findSpeed().has_value(), gap_s < 1.0) << gap_s;
  }
}

TEST(RoadProfileOdometry, WithoutARoadItStartsAnew) {
  Tunnel tunnel;
  tunnel.profile_m = 0.006;
  RoadProfileOdometry relief{RoadProfileOdometry::Params()};
  drive(relief, tunnel, 13.0, 5);
  relief.add(CorrectedSweep(), T_cog_lidar(), Vector6d::Zero(), Pose::Identity());
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
