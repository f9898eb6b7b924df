#include "simulation/terrain.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fail_aware::terrain_test {
namespace {

TEST(Terrain, GradientIsTheHeightsDerivative) {
  const Terrain terrain(3, 0.03);
  const double h = 1e-4;
  for (const Eigen::Vector2d& p : {Eigen::Vector2d(0, 0), Eigen::Vector2d(123, -45), Eigen::Vector2d(-900, 777)}) {
    const Eigen::Vector2d gradient = terrain.gradient(p);
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d step = h * Eigen::Vector2d::Unit(axis);
      EXPECT_NEAR(gradient[axis], (terrain.height(p + step) - terrain.height(p - step)) / (2 * h), 1e-7);
    }
  }
}

TEST(Terrain, SlopeAndBumpsAreAsAskedFor) {
  const double grade = 0.03;
  double slope2 = 0.0, bumps2 = 0.0, roughness2 = 0.0;
  int count = 0;
  const Terrain terrain(4, grade);
  for (double x = -4000; x < 4000; x += 53.0) {
    for (double y = -4000; y < 4000; y += 47.0, ++count) {
      slope2 += terrain.gradient({x, y}).squaredNorm();
      bumps2 += std::pow(terrain.bumps({x, y}), 2);
      roughness2 += std::pow(terrain.roadRoughness({x, y}), 2);
    }
  }
  EXPECT_NEAR(std::sqrt(slope2 / count), grade, 0.2 * grade);
  EXPECT_NEAR(std::sqrt(bumps2 / count), 1.0, 0.2);
  EXPECT_NEAR(std::sqrt(roughness2 / count), 0.0027, 0.0007);  // ISO 8608 class B, wavelengths of 0.6 to 12 m
}

TEST(Terrain, TheRoadHasNoStepsAndRepeatsItself) {
  const Terrain terrain(5, 0.03);
  constexpr double kTile_m = 76.8;
  for (double x = -80.0; x < 80.0; x += 0.37) {
    const Eigen::Vector2d p(x, 0.3 * x);
    EXPECT_NEAR(terrain.roadRoughness(p), terrain.roadRoughness(p + Eigen::Vector2d(0.01, 0.0)), 0.0015);
    EXPECT_NEAR(terrain.roadRoughness(p), terrain.roadRoughness(p + Eigen::Vector2d(kTile_m, -kTile_m)), 1e-6);
  }
}

}  // namespace
}  // namespace fail_aware::terrain_test
