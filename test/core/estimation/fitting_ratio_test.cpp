#include "core/estimation/fitting_ratio.hpp"

#include <gtest/gtest.h>

namespace fail_aware::fitting_ratio_test {
namespace {

/// After 20 sweeps of 1000 points, 850 of which fit.
FittingRatio afterTown() {
  FittingRatio fitting;
  for (int i = 0; i < 20; ++i) EXPECT_DOUBLE_EQ(fitting.add(0.85, 850), 0.85);
  return fitting;
}

TEST(FittingRatio, PointsInTheAirDoNotLowerIt) {
  FittingRatio fitting = afterTown();
  for (int i = 0; i < 100; ++i) EXPECT_NEAR(fitting.add(0.28, 840), 0.84, 1e-9) << i;  // 3000 points
}

TEST(FittingRatio, SceneryThatDoesNotFitLowersIt) {
  FittingRatio fitting = afterTown();
  EXPECT_DOUBLE_EQ(fitting.add(0.2, 200), 0.2);
  EXPECT_DOUBLE_EQ(fitting.add(0.2, 40), 0.2) << "fog: the few points that are left do not fit";
  EXPECT_NEAR(fitting.add(0.1, 200), 0.2, 1e-9) << "points in the air, and the others do not fit either";
}

TEST(FittingRatio, FewPointsThatFitAreEnough) {
  FittingRatio fitting = afterTown();
  EXPECT_DOUBLE_EQ(fitting.add(0.9, 90), 0.9);
}

TEST(FittingRatio, UnknownUsualNumberLeavesTheInlierRatio) {
  FittingRatio fitting;
  EXPECT_DOUBLE_EQ(fitting.add(0.85, 100), 0.85);
  EXPECT_DOUBLE_EQ(fitting.add(0.28, 840), 0.28);
  FittingRatio cleared = afterTown();
  cleared.clear();
  EXPECT_DOUBLE_EQ(cleared.add(0.28, 840), 0.28);
}

TEST(FittingRatio, NoInlierIsZero) {
  FittingRatio fitting = afterTown();
  EXPECT_EQ(fitting.add(0.0, 0), 0.0);
}

}  // namespace
}  // namespace fail_aware::fitting_ratio_test
