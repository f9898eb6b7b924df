#include "simulation/road.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace fail_aware::road_test {
namespace {

Road makeRoad(const std::string& scene, std::uint64_t seed, double length_m) {
  Road road(seed, ScenePlan::parse(scene, 100.0));
  road.extendTo(length_m);
  return road;
}

TEST(Road, IsSmoothAndMeasuredByItsLength) {
  for (const char* scene : {"town", "country", "highway", "tunnel", "open"}) {
    const Road road = makeRoad(scene, 5, 3000.0);
    for (double s = -150.0; s < 2990.0; s += 0.7) {
      const RoadPoint a = road.at(s), b = road.at(s + 0.7);
      ASSERT_NEAR((b.position - a.position).norm(), 0.7, 1e-3) << scene << " " << s;
      ASSERT_NEAR(b.heading_rad - a.heading_rad, 0.35 * (a.curvature_per_m + b.curvature_per_m), 2e-3) << scene;
    }
  }
}

TEST(Road, NeverComesNearItself) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Road road = makeRoad("town", seed, 4000.0);
    for (double a = 0.0; a < 4000.0; a += 10.0) {
      for (double b = a + 100.0; b < 4000.0; b += 10.0) {
        ASSERT_GT((road.at(a).position - road.at(b).position).norm(), 25.0) << seed << " " << a << " " << b;
      }
    }
  }
}

TEST(Road, DoesNotDependOnHowItIsAskedFor) {
  Road a(9, ScenePlan::parse("country", 100.0)), b(9, ScenePlan::parse("country", 100.0));
  a.extendTo(2000.0);
  for (double s = 0.0; s <= 2000.0; s += 37.0) {
    b.extendTo(s);
    b.forgetBefore(s - 100.0);
  }
  b.extendTo(2000.0);
  EXPECT_EQ(a.at(1950.0).position, b.at(1950.0).position);
  EXPECT_GT(b.begin(), 1800.0);
}

TEST(Road, ProjectionFindsThePlaceBeside) {
  const Road road = makeRoad("country", 2, 1000.0);
  for (double s : {10.0, 333.0, 700.0}) {
    const RoadPoint point = road.at(s);
    EXPECT_NEAR(road.project(point.position + 3.0 * point.left(), s + 4.0), s, 0.02);
    EXPECT_NEAR(road.distance(point.position - 7.0 * point.left(), s, 50.0), 7.0, 0.15);
  }
}

TEST(Road, WidthChangesGraduallyBetweenParts) {
  const Road road = makeRoad("town:300,tunnel", 1, 800.0);
  const double town = roadCharacter(SceneKind::kTown).half_width_m;
  const double tunnel = roadCharacter(SceneKind::kTunnel).half_width_m;
  EXPECT_DOUBLE_EQ(road.halfWidth(200.0), town);
  EXPECT_DOUBLE_EQ(road.halfWidth(400.0), tunnel);
  EXPECT_NEAR(road.halfWidth(300.0), 0.5 * (town + tunnel), 1e-9);
  for (double s = 250.0; s < 350.0; s += 1.0) EXPECT_LT(std::abs(road.halfWidth(s + 1.0) - road.halfWidth(s)), 0.2);
}

}  // namespace
}  // namespace fail_aware::road_test
