#include "simulation/scene_chunk.hpp"

#include <algorithm>
#include <cmath>

namespace fail_aware {

namespace {

constexpr double kReach_m = 110.0;  // range along the road in which another part of the road may come close

}  // namespace

SceneChunk::SceneChunk(std::uint64_t seed, const Road& road, const Terrain& terrain, double begin_m, double end_m)
    : seed_(seed), road_(road), terrain_(terrain), begin_m_(begin_m), end_m_(end_m) {
  const Eigen::Vector2d middle = road.at(0.5 * (begin_m + end_m)).position;
  origin_ << middle, terrain.height(middle);
}

RandomStream SceneChunk::random(std::uint64_t sort, std::int64_t index) const {
  return RandomStream(combineKeys(seed_, sort, static_cast<std::uint64_t>(index)));
}

std::int64_t SceneChunk::firstIndex(double spacing_m) const {
  return static_cast<std::int64_t>(std::ceil(begin_m_ / spacing_m));
}

Place SceneChunk::place(double s_m, double lateral_m, double lift_m) const {
  const RoadPoint road = road_.at(s_m);
  const Eigen::Vector2d p = road.position + lateral_m * road.left();
  Place place = Place::Identity();
  place.translation() << p - origin_.head<2>(), terrain_.height(p) + lift_m - origin_.z();
  place.linear() = Eigen::AngleAxisd(road.heading_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return place;
}

bool SceneChunk::isClear(double s_m, double lateral_m, double clearance_m) const {
  const RoadPoint road = road_.at(s_m);
  const Eigen::Vector2d p = road.position + lateral_m * road.left();
  return road_.distance(p, s_m, kReach_m) > road_.halfWidth(s_m) + clearance_m;
}

void SceneChunk::addRibbon(double from_m, double to_m, double step_m, const Edge& a, const Edge& b, Material material) {
  from_m = std::max(from_m, begin_m_);
  to_m = std::min(to_m, end_m_);
  if (to_m <= from_m) return;
  const int steps = std::max(1, static_cast<int>(std::ceil((to_m - from_m) / step_m - 1e-9)));
  std::uint32_t last_a = 0, last_b = 0;
  for (int i = 0; i <= steps; ++i) {
    const double s = from_m + (to_m - from_m) * i / steps;
    const std::uint32_t at_a = mesh.addVertex(place(s, a.lateral_m, a.height_m).translation());
    const std::uint32_t at_b = mesh.addVertex(place(s, b.lateral_m, b.height_m).translation());
    if (i > 0) {
      mesh.addTriangle(last_a, at_a, at_b, material);
      mesh.addTriangle(last_a, at_b, last_b, material);
    }
    last_a = at_a;
    last_b = at_b;
  }
}

}  // namespace fail_aware
