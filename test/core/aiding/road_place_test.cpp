#include "core/aiding/road_place.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

namespace fail_aware::road_place_test {
namespace {

constexpr double kCell_m = 0.25;

/// A road whose waves of 2 to 5 m never repeat. phase: another road.
double heightAt(double x, double y, double phase) {
  return 0.002 * (std::sin(2.1 * x + 0.7 * y + phase) + std::sin(1.27 * x - 0.4 * y + 2.0 * phase) +
                  std::sin(2.9 * x + 1.1 * y + 3.0 * phase));
}

/// The road 16 m around the place x_m, seen in axes turned by yaw_rad.
RoadProfile profileAt(double x_m, double yaw_rad = 0.0, double phase = 0.0) {
  RoadProfile profile;
  const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  for (double x = -15.875; x < 16.0; x += kCell_m) {
    for (double y = -3.875; y < 4.0; y += kCell_m) {
      const double height = heightAt(x_m + c * x - s * y, s * x + c * y, phase);
      profile.cells.push_back(
          {static_cast<float>(x), static_cast<float>(y), 0.0f, static_cast<float>(height), 1.0f / (0.005f * 0.005f)});
    }
  }
  return profile;
}

/// Sweeps a metre apart; the newest is at 0 and was predicted error_m ahead.
std::vector<RoadProfile> drive(int sweeps, double error_m, double phase_of_newest = 0.0) {
  std::vector<RoadProfile> profiles;
  for (int k = sweeps - 1; k > 0; --k) {
    const double yaw_rad = -0.01 * k;
    RoadProfile profile = profileAt(-1.0 * k, yaw_rad);
    profile.T_newest_this.linear() = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    profile.T_newest_this.translation().x() = -1.0 * k - error_m;
    profiles.push_back(profile);
  }
  profiles.push_back(profileAt(0.0, 0.0, phase_of_newest));
  return profiles;
}

std::optional<RoadPlace> find(const std::vector<RoadProfile>& profiles) {
  return findRoadPlace(profiles, kCell_m, 0.002, 0.6);
}

TEST(RoadPlace, IsWhereTheProfilesAgree) {
  for (const double error_m : {-0.37, -0.05, 0.0, 0.2, 0.41}) {
    const std::optional<RoadPlace> place = find(drive(12, error_m));
    ASSERT_TRUE(place.has_value()) << error_m;
    EXPECT_NEAR(place->offset_m, -error_m, 0.02) << error_m;
    EXPECT_GT(place->correlation, 0.9) << error_m;
    EXPECT_GE(place->sigma_m, 0.05) << error_m;
    EXPECT_LT(place->sigma_m, 0.1) << error_m;
  }
}

TEST(RoadPlace, BeyondTheSearchIsNone) { EXPECT_FALSE(find(drive(12, 0.9)).has_value()); }

TEST(RoadPlace, OnAnotherRoadIsUncertainOrNone) {
  for (const double phase : {1.0, 2.0, 3.0, 4.0}) {
    const std::optional<RoadPlace> place = find(drive(12, 0.0, phase));
    EXPECT_TRUE(!place || place->correlation < 0.6) << phase;
  }
}

TEST(RoadPlace, NeedsSweepsFarEnoughBehind) {
  EXPECT_FALSE(find(drive(4, 0.0)).has_value()) << "two are 2 m behind";
  EXPECT_TRUE(find(drive(6, 0.0)).has_value());
  EXPECT_FALSE(find({}).has_value());
}

}  // namespace
}  // namespace fail_aware::road_place_test
