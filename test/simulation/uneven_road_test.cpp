#include "simulation/uneven_road.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fail_aware::uneven_road_test {
namespace {

/// A ray from 1.7 m above the smooth road, down at this angle.
struct Ray {
  explicit Ray(double down_rad)
      : direction(static_cast<float>(std::cos(down_rad)), 0.0f, static_cast<float>(-std::sin(down_rad))) {
    hit.range_m = static_cast<float>(from.z() / std::sin(down_rad));
    hit.incidence_cos = static_cast<float>(std::sin(down_rad));
  }
  Eigen::Vector3d from{100.0, 20.0, 1.7};
  Eigen::Vector3f direction;
  RayHit hit;
};

TEST(UnevenRoad, TheRayEndsOnTheUnevenRoad) {
  const Terrain terrain(6, 0.03);
  for (const double down_rad : {0.4, 0.2, 0.1}) {
    for (int i = 0; i < 50; ++i) {
      Ray ray(down_rad);
      ray.from.x() += 1.1 * i;
      const float range_m = rangeOnUnevenRoad(ray.from, ray.direction, ray.hit, terrain);
      const Eigen::Vector3d end = ray.from + static_cast<double>(range_m) * ray.direction.cast<double>();
      EXPECT_NEAR(end.z(), terrain.roadRoughness(end.head<2>()), 2e-4) << down_rad << " " << i;
    }
  }
}

TEST(UnevenRoad, AFlatRayKeepsItsRange) {
  const Terrain terrain(6, 0.03);
  const Ray ray(0.009);
  EXPECT_EQ(rangeOnUnevenRoad(ray.from, ray.direction, ray.hit, terrain), ray.hit.range_m);
}

}  // namespace
}  // namespace fail_aware::uneven_road_test
