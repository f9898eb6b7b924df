#include "simulation/uneven_road.hpp"

namespace fail_aware {

namespace {

constexpr float kFlattest = 0.01f;  // cosine; below it the unevenness is as steep as the ray
constexpr int kSteps = 3;           // the shift changes where the unevenness counts

}  // namespace

float rangeOnUnevenRoad(const Eigen::Vector3d& from_world, const Eigen::Vector3f& direction_world, const RayHit& hit,
                        const Terrain& terrain) {
  if (hit.incidence_cos < kFlattest) return hit.range_m;
  float range_m = hit.range_m;
  for (int step = 0; step < kSteps; ++step) {
    const Eigen::Vector2d p = from_world.head<2>() + (range_m * direction_world.head<2>()).cast<double>();
    range_m = hit.range_m - static_cast<float>(terrain.roadRoughness(p)) / hit.incidence_cos;
  }
  return range_m;
}

}  // namespace fail_aware
