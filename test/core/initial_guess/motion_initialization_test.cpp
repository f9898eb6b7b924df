#include "core/initial_guess/motion_initialization.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>
#include <random>

#include "../../support/synthetic_drive.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::motion_initialization_test {
namespace {

constexpr double kMinRange_m = 3.0;

MotionInitialization::Params testParams() {
  MotionInitialization::Params params;
  params.min_speed_mps = -5.0;
  params.max_speed_mps = 45.0;
  params.step_mps = 2.0;
  params.max_yaw_rate_rps = 0.7;
  params.step_yaw_rate_rps = 0.1;
  params.max_lateral_acceleration_mps2 = 8.0;
  params.max_range_m = 40.0;
  return params;
}

std::optional<MotionInitialization::Found> twistFound(const SyntheticDrive& drive,
                                                      const MotionInitialization::Params& params, double dt_s = 0.1) {
  MotionInitialization initialization(params, kMinRange_m);
  initialization.setFirst(drive.sweep(0.0, 1), drive.T_cog_lidar);
  return initialization.find(drive.sweep(dt_s, 2), drive.T_cog_lidar, dt_s);
}

void expectTwist(const std::optional<MotionInitialization::Found>& found, double speed_mps, double yaw_rate_rps) {
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->twist_cog[0], speed_mps, 0.7);
  EXPECT_NEAR(found->twist_cog[5], yaw_rate_rps, 0.06);
  for (const int i : {1, 2, 3, 4}) EXPECT_EQ(found->twist_cog[i], 0.0);
}

TEST(MotionInitialization, FindsSpeedBehindACar) {
  SyntheticDrive drive;
  drive.car_ahead = drive.ground_rings = true;
  drive.twist_cog = planarTwist(14.0, 0.0);
  expectTwist(twistFound(drive, testParams()), 14.0, 0.0);
}

TEST(MotionInitialization, FindsACurveBehindACar) {
  SyntheticDrive drive;
  drive.car_ahead = drive.ground_rings = true;
  drive.twist_cog = planarTwist(10.0, 0.4);
  expectTwist(twistFound(drive, testParams()), 10.0, 0.4);
}

/// Two hedges that the beams hit in the same pattern in every sweep, but for 0.4 m if rough, and poles; the vehicle has
/// moved by moved_m.
CorrectedSweep hedgesAndPoles(double moved_m, int poles = 16, unsigned rough = 0) {
  CorrectedSweep sweep;
  const auto add = [&sweep](double x, double y, double z) {
    sweep.points_lidar.push_back(Eigen::Vector3d(x, y, z).cast<float>());
  };
  std::mt19937 random(1), roughness(rough);
  const auto uniform = [&random](double low, double high) {
    return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
  };
  for (int i = 0; i < 1600; ++i) {
    const double leaf_m = rough > 0 ? 0.8 * (static_cast<double>(roughness()) / 4294967296.0 - 0.5) : 0.0;
    add(uniform(-20.0, 20.0), (i % 2 ? 6.0 : -6.0) + uniform(-0.5, 0.5) + leaf_m, uniform(0.0, 2.0));
  }
  for (int pole = 0; pole < poles; ++pole) {
    for (int k = 0; k <= 10; ++k) add(2.4 * pole - 18.0 - moved_m, pole % 2 ? 12.0 : -12.0, 0.2 * k);
  }
  return sweep;
}

TEST(MotionInitialization, PolesDecideBetweenHedges) {
  MotionInitialization initialization(testParams(), kMinRange_m);
  initialization.setFirst(hedgesAndPoles(0.0), Pose::Identity());
  expectTwist(initialization.find(hedgesAndPoles(2.7), Pose::Identity(), 0.1), 27.0, 0.0);
}

/// Eight poles cannot outvote the hedges, which fit best at standstill. But they do not fit as at a true standstill.
TEST(MotionInitialization, AStandstillThatFitsBadlyIsNone) {
  MotionInitialization initialization(testParams(), kMinRange_m);
  initialization.setFirst(hedgesAndPoles(0.0, 8, 1), Pose::Identity());
  expectTwist(initialization.find(hedgesAndPoles(2.7, 8, 2), Pose::Identity(), 0.1), 27.0, 0.0);
  expectTwist(initialization.find(hedgesAndPoles(0.0, 8, 2), Pose::Identity(), 0.1), 0.0, 0.0);
}

/// Cars that travel along beside the lidar, fences behind them that the cars hide in part, and poles; the vehicle has
/// moved by moved_m.
CorrectedSweep convoy(double moved_m, int poles) {
  constexpr double kCar_m = 3.5, kFence_m = 9.0, kPole_m = 14.0;
  constexpr double kRears_m[] = {-9.0, -3.0, 3.0};
  CorrectedSweep sweep;
  const auto add = [&sweep](double x, double y, double low_m, double high_m) {
    for (double z = low_m; z <= high_m; z += 0.2) {
      sweep.points_lidar.push_back(Eigen::Vector3d(x, y, z).cast<float>());
    }
  };
  for (const double side : {-1.0, 1.0}) {
    for (const double rear_m : kRears_m) {
      for (double x = rear_m; x <= rear_m + 3.0; x += 0.1) add(x, side * kCar_m, -1.2, 0.3);
    }
    for (double x = -36.0; x <= 36.0; x += 0.1) {
      const double at_cars_m = x * kCar_m / kFence_m;
      const bool hidden = std::any_of(std::begin(kRears_m), std::end(kRears_m), [at_cars_m](double rear_m) {
        return at_cars_m >= rear_m && at_cars_m <= rear_m + 3.0;
      });
      if (!hidden) add(x, side * kFence_m, -1.2, -0.2);
    }
  }
  for (int pole = 0; pole < poles; ++pole) {
    add(3.3 * pole - 0.5 * 3.3 * poles - moved_m, pole % 2 ? kPole_m : -kPole_m, 1.4, 4.0);  // seen above the cars
  }
  return sweep;
}

/// The shadows of the cars travel along: where a shadow ends, the fence meets nothing at the true speed.
TEST(MotionInitialization, WhatACarHidesSpeaksForNoSpeed) {
  MotionInitialization initialization(testParams(), kMinRange_m);
  initialization.setFirst(convoy(0.0, 9), Pose::Identity());
  expectTwist(initialization.find(convoy(2.7, 9), Pose::Identity(), 0.1), 27.0, 0.0);
}

TEST(MotionInitialization, FindsTheDistanceFromTheFirstSweep) {
  constexpr double kStandingRatio = 0.9;
  SyntheticDrive drive;
  MotionInitialization initialization(testParams(), kMinRange_m);
  EXPECT_FALSE(initialization.findDistance(drive.sweep(0.0, 1), drive.T_cog_lidar, 0.0, kStandingRatio));
  initialization.setFirst(drive.sweep(0.0, 1), drive.T_cog_lidar);
  const auto here = initialization.findDistance(drive.sweep(0.5, 1), drive.T_cog_lidar, 0.0, kStandingRatio);
  ASSERT_TRUE(here);
  EXPECT_EQ(*here, 0.0) << "the beams hit the same spots";
  drive.twist_cog = planarTwist(1.5, 0.2);
  const auto ahead = initialization.findDistance(drive.sweep(1.0, 2), drive.T_cog_lidar, 0.2, kStandingRatio);
  ASSERT_TRUE(ahead);
  EXPECT_NEAR(*ahead, 1.5, 0.1);
}

TEST(MotionInitialization, FindsStandstillAndReverse) {
  SyntheticDrive drive;
  drive.ground_rings = true;
  expectTwist(twistFound(drive, testParams()), 0.0, 0.0);
  drive.twist_cog = planarTwist(-3.0, -0.2);
  expectTwist(twistFound(drive, testParams()), -3.0, -0.2);
}

TEST(MotionInitialization, SearchesUpToItsLimits) {
  MotionInitialization::Params params = testParams();
  SyntheticDrive drive;
  drive.twist_cog = planarTwist(6.0, 0.7);
  expectTwist(twistFound(drive, params), 6.0, 0.7);
  params.max_yaw_rate_rps = 0.5;
  const auto cut = twistFound(drive, params);
  ASSERT_TRUE(cut.has_value());
  EXPECT_LE(cut->twist_cog[5], 0.5 + 1e-9);
  params = testParams();
  params.max_speed_mps = 9.0;
  drive.twist_cog = planarTwist(9.0, 0.0);
  expectTwist(twistFound(drive, params), 9.0, 0.0);
}

TEST(MotionInitialization, TimeScalesTheMotion) {
  SyntheticDrive drive;
  drive.twist_cog = planarTwist(9.0, 0.1);
  expectTwist(twistFound(drive, testParams(), 0.2), 9.0, 0.1);
}

TEST(MotionInitialization, FindsNothingWithoutAFirstSweep) {
  MotionInitialization initialization(testParams(), kMinRange_m);
  const SyntheticDrive drive;
  EXPECT_FALSE(initialization.find(drive.sweep(0.0, 1), drive.T_cog_lidar, 0.1).has_value());
  initialization.setFirst(drive.sweep(0.0, 1), drive.T_cog_lidar);
  initialization.reset();
  EXPECT_FALSE(initialization.find(drive.sweep(0.0, 1), drive.T_cog_lidar, 0.1).has_value());
}

TEST(MotionInitialization, FindsNothingWhereNothingStands) {
  SyntheticDrive drive;
  drive.twist_cog = planarTwist(10.0, 0.0);
  drive.scene = {ground(-40.0, -40.0, 40.0, 40.0)};
  EXPECT_FALSE(twistFound(drive, testParams()).has_value());
  MotionInitialization initialization(testParams(), kMinRange_m);
  initialization.setFirst(drive.sweep(0.0, 1), drive.T_cog_lidar);
  EXPECT_FALSE(initialization.find(CorrectedSweep(), drive.T_cog_lidar, 0.1).has_value());
}

TEST(MotionInitialization, FindsNothingWhereTheSweepsDoNotOverlap) {
  SyntheticDrive here, elsewhere;
  here.scene = {wall(-20.0, -10.0, 20.0, -10.0, 4.0)};
  elsewhere.scene = {wall(-20.0, 15.0, 20.0, 15.0, 4.0)};
  MotionInitialization initialization(testParams(), kMinRange_m);
  initialization.setFirst(here.sweep(0.0, 1), here.T_cog_lidar);
  EXPECT_FALSE(initialization.find(elsewhere.sweep(0.1, 2), elsewhere.T_cog_lidar, 0.1).has_value());
}

TEST(MotionInitialization, LooksNoFartherThanItsRange) {
  MotionInitialization::Params params = testParams();
  SyntheticDrive drive;
  drive.scene = {wall(20.0, -10.0, 20.0, 10.0, 4.0)};
  EXPECT_TRUE(twistFound(drive, params).has_value());
  params.max_range_m = 15.0;
  EXPECT_FALSE(twistFound(drive, params).has_value());
}

TEST(MotionInitialization, FindsNothingWithoutTimeBetween) {
  MotionInitialization initialization(testParams(), kMinRange_m);
  const SyntheticDrive drive;
  initialization.setFirst(drive.sweep(0.0, 1), drive.T_cog_lidar);
  for (const double dt_s : {0.0, -0.1, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_FALSE(initialization.find(drive.sweep(0.0, 2), drive.T_cog_lidar, dt_s).has_value()) << dt_s;
  }
}

TEST(MotionInitialization, ValidatesItsParameters) {
  const auto rejects = [](auto change) {
    MotionInitialization::Params params = testParams();
    change(params);
    EXPECT_THROW(validate(params), ParameterError);
  };
  EXPECT_NO_THROW(validate(MotionInitialization::Params()));
  rejects([](auto& p) { p.max_speed_mps = -6.0; });
}

}  // namespace
}  // namespace fail_aware::motion_initialization_test
