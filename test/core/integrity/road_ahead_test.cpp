#include "core/integrity/road_ahead.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>

namespace fail_aware::road_ahead_test {
namespace {

constexpr double kWeak = 0.01;  // MonitorParameters::min_information_ratio

RoadAhead after(std::initializer_list<double> ratios) {
  RoadAhead road;
  for (const double ratio : ratios) road.add({ratio, 50.0});
  return road;
}

TEST(RoadAhead, IsWeakWhereNineSweepsSeeIt) {
  EXPECT_FALSE(after({0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}).isWeak(kWeak)) << "eight";
  EXPECT_TRUE(after({0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}).isWeak(kWeak));
  EXPECT_TRUE(after({0.4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}).isWeak(kWeak)) << "one counts up to the limit";
  EXPECT_FALSE(after({0.003, 0.003, 0.003, 0.003, 0.003, 0.003, 0.003, 0.003, 0.003}).isWeak(kWeak));
}

TEST(RoadAhead, ASweepThatSeesNothingDoesNotCount) {
  EXPECT_TRUE(after({0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0}).isWeak(kWeak)) << "six see a tunnel";
  EXPECT_FALSE(after({0.0, 1.0, 1.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0}).isWeak(kWeak)) << "four are too few";
}

// A simulated highway (seed 80504, half sweeps), where the median of five sweeps is below a fifth of the limit.
TEST(RoadAhead, ChanceBetweenRailsIsNoTunnel) {
  EXPECT_FALSE(after({0.0054, 0.0337, 0.0, 0.0018, 0.0057, 0.0006, 0.0, 0.0305, 0.0073}).isWeak(kWeak));
  EXPECT_FALSE(after({0.0018, 0.0057, 0.0006, 0.0, 0.0305, 0.0073, 0.0, 0.0188, 0.0071}).isWeak(kWeak));
}

TEST(RoadAhead, IsTheMedianOfFive) {
  EXPECT_FALSE(RoadAhead().ahead().known());
  EXPECT_EQ(after({0.5, 0.5, 0.1, 0.001, 0.002, 0.003, 0.004}).ahead().ratio, 0.003);
  RoadAhead road = after({0.003, 0.003});
  for (int i = 0; i < 3; ++i) road.add({std::nan(""), 50.0});
  EXPECT_FALSE(road.ahead().known()) << "what is not valid sees nothing";
}

}  // namespace
}  // namespace fail_aware::road_ahead_test
