#include "core/aiding/road_surface.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fail_aware::road_surface_test {
namespace {

/// A plane 1.7 m below the lidar that rises by `slope` ahead, a bump of 20 mm in it between x = 8 and 9 m.
CorrectedSweep slopingRoad(double slope) {
  CorrectedSweep sweep;
  for (int i = 0; i <= 100; ++i) {
    for (int k = -30; k <= 30; ++k) {
      const double x = 4.0 + 0.1 * i, y = 0.1 * k, bump = x > 8.0 && x < 9.0 ? 0.02 : 0.0;
      sweep.points_lidar.push_back(Eigen::Vector3d(x, y, -1.7 + slope * x + bump).cast<float>());
    }
  }
  return sweep;
}

TEST(RoadSurface, HeightsAreThoseAboveTheSlope) {
  const auto samples = sampleRoad(slopingRoad(0.03), Pose::Identity(), Vector6d(Vector6d::Zero()));
  ASSERT_TRUE(samples);
  ASSERT_GT(samples->size(), 1000u);
  for (const RoadSample& sample : *samples) {
    if (sample.x > 8.2f && sample.x < 8.8f) {
      EXPECT_NEAR(sample.height, 0.02, 0.01) << sample.x;
    } else if (sample.x < 7.8f || sample.x > 9.2f) {
      EXPECT_NEAR(sample.height, 0.0, 0.01) << sample.x;
    }
    EXPECT_GT(sample.weight, 0.0f);
  }
}

TEST(RoadSurface, ASampleWeighsWhatItsPointsTellOfTheHeight) {
  const auto samples = sampleRoad(slopingRoad(0.0), Pose::Identity(), Vector6d(Vector6d::Zero()));
  ASSERT_TRUE(samples);
  for (const RoadSample& sample : *samples) {
    const double sigma_m = 0.02 * 1.7 / std::hypot(sample.x, sample.y);
    EXPECT_NEAR(sample.weight * sigma_m * sigma_m, std::round(sample.weight * sigma_m * sigma_m), 0.1);
  }
}

TEST(RoadSurface, TooLittleRoadIsNone) {
  CorrectedSweep sweep = slopingRoad(0.0);
  sweep.points_lidar.resize(500);
  EXPECT_FALSE(sampleRoad(sweep, Pose::Identity(), Vector6d(Vector6d::Zero())));
}

}  // namespace
}  // namespace fail_aware::road_surface_test
