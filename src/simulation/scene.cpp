#include "simulation/scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "simulation/country_scene.hpp"
#include "simulation/highway_scene.hpp"
#include "simulation/open_scene.hpp"
#include "simulation/town_scene.hpp"
#include "simulation/tunnel_scene.hpp"

namespace fail_aware {

namespace {

constexpr double kRoadAhead_m = 400.0, kRoadBehind_m = 190.0;
constexpr double kRoadStep_m = 2.0;
constexpr double kChunk_m = 25.0, kAhead_m = 160.0, kBehind_m = 140.0;
constexpr double kCell_m = 40.0, kGroundRadius_m = 130.0, kGroundForget_m = 150.0;
constexpr int kGrid = 16;                                 // squares along a cell's side
constexpr double kVergeBegin_m = 3.0, kVergeEnd_m = 7.0;  // distances from the asphalt: smooth before, rough after

std::int64_t chunkId(std::int64_t index) { return 2 * index; }
std::int64_t cellId(const std::pair<std::int64_t, std::int64_t>& cell) {
  return 2 * (cell.first * (std::int64_t{1} << 30) + cell.second) + 1;
}

double smoothStep(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3.0 - 2.0 * x);
}

Material groundMaterial(SceneKind kind) {
  return kind == SceneKind::kTown || kind == SceneKind::kTunnel ? Material::kPavement : Material::kGrass;
}

double distanceToCell(const Eigen::Vector2d& p, const std::pair<std::int64_t, std::int64_t>& cell) {
  const Eigen::Vector2d low(kCell_m * static_cast<double>(cell.first), kCell_m * static_cast<double>(cell.second));
  const Eigen::Vector2d nearest = p.cwiseMax(low).cwiseMin(low + Eigen::Vector2d::Constant(kCell_m));
  return (p - nearest).norm();
}

}  // namespace

Scene::Scene(std::uint64_t seed, const ScenePlan& plan)
    : seed_(combineKeys(seed, 21)), terrain_(seed, plan.grade()), road_(seed, plan) {
  road_.extendTo(kRoadAhead_m);
}

SceneChange Scene::update(const Eigen::Vector2d& position, double s_m) {
  road_.extendTo(s_m + kRoadAhead_m);
  road_.forgetBefore(s_m - kRoadBehind_m);
  SceneChange change;
  updateChunks(s_m, change);
  updateGround(position, s_m, change);
  return change;
}

void Scene::updateChunks(double s_m, SceneChange& change) {
  const auto first = static_cast<std::int64_t>(std::floor((s_m - kBehind_m) / kChunk_m));
  const auto last = static_cast<std::int64_t>(std::floor((s_m + kAhead_m) / kChunk_m));
  while (!chunks_.empty() && *chunks_.begin() < first) {
    change.removed.push_back(chunkId(*chunks_.begin()));
    chunks_.erase(chunks_.begin());
  }
  for (std::int64_t index = chunks_.empty() ? first : *chunks_.rbegin() + 1; index <= last; ++index) {
    chunks_.insert(index);
    change.added.push_back(makeChunk(index));
  }
}

void Scene::updateGround(const Eigen::Vector2d& position, double s_m, SceneChange& change) {
  for (auto cell = cells_.begin(); cell != cells_.end();) {
    if (distanceToCell(position, *cell) > kGroundForget_m) {
      change.removed.push_back(cellId(*cell));
      cell = cells_.erase(cell);
    } else {
      ++cell;
    }
  }
  const auto index = [](double x) { return static_cast<std::int64_t>(std::floor(x / kCell_m)); };
  for (std::int64_t x = index(position.x() - kGroundRadius_m); x <= index(position.x() + kGroundRadius_m); ++x) {
    for (std::int64_t y = index(position.y() - kGroundRadius_m); y <= index(position.y() + kGroundRadius_m); ++y) {
      const Cell cell(x, y);
      if (cells_.count(cell) != 0 || distanceToCell(position, cell) > kGroundRadius_m) continue;
      cells_.insert(cell);
      change.added.push_back(makeGround(cell, s_m));
    }
  }
}

SceneTile Scene::makeChunk(std::int64_t index) const {
  const double begin_m = kChunk_m * static_cast<double>(index);
  SceneChunk chunk(seed_, road_, terrain_, begin_m, begin_m + kChunk_m);
  switch (road_.kindAt(begin_m + 0.5 * kChunk_m)) {
    case SceneKind::kTown: buildTown(chunk); break;
    case SceneKind::kCountry: buildCountry(chunk); break;
    case SceneKind::kHighway: buildHighway(chunk); break;
    case SceneKind::kTunnel: buildTunnel(chunk); break;
    case SceneKind::kOpen: buildOpen(chunk); break;
  }
  return {chunkId(index), chunk.origin(), std::move(chunk.mesh)};
}

SceneTile Scene::makeGround(const Cell& cell, double s_m) const {
  const Eigen::Vector2d low(kCell_m * static_cast<double>(cell.first), kCell_m * static_cast<double>(cell.second));
  const Eigen::Vector2d middle = low + Eigen::Vector2d::Constant(0.5 * kCell_m);
  // the part of the road that can be near this cell, thinned
  struct Near {
    Eigen::Vector2d position;
    double half_width_m, roughness_m;
  };
  std::vector<Near> near;
  double nearest_m = 1e9;
  SceneKind kind = road_.kindAt(s_m);
  const double from_m = std::max(road_.begin(), s_m - kRoadBehind_m);
  const int steps = static_cast<int>(std::floor((s_m + kRoadAhead_m - from_m) / kRoadStep_m));
  for (int step = 0; step <= steps; ++step) {
    const double s = from_m + kRoadStep_m * step;
    const Eigen::Vector2d p = road_.at(s).position;
    const double distance_m = (p - middle).norm();
    if (distance_m < nearest_m) {
      nearest_m = distance_m;
      kind = road_.kindAt(s);
    }
    if (distance_m > 0.75 * kCell_m + 25.0) continue;
    near.push_back({p, road_.halfWidth(s), roadCharacter(road_.kindAt(s)).verge_roughness_m});
  }

  SceneTile tile;
  tile.id = cellId(cell);
  tile.origin << middle, terrain_.height(middle);
  constexpr double kSpacing_m = kCell_m / kGrid;
  constexpr int kSide = kGrid + 1;
  std::vector<double> beside_road_m;
  beside_road_m.reserve(static_cast<std::size_t>(kSide) * kSide);
  const double far_roughness_m = roadCharacter(kind).verge_roughness_m;
  for (int iy = 0; iy < kSide; ++iy) {
    for (int ix = 0; ix < kSide; ++ix) {
      const Eigen::Vector2d p = low + kSpacing_m * Eigen::Vector2d(ix, iy);
      double beside_m = 1e9, roughness_m = far_roughness_m;
      for (const Near& road : near) {
        const double d = (road.position - p).norm() - road.half_width_m;
        if (d >= beside_m) continue;
        beside_m = d;
        roughness_m = road.roughness_m;
      }
      beside_road_m.push_back(beside_m);
      const double rough = smoothStep((beside_m - kVergeBegin_m) / (kVergeEnd_m - kVergeBegin_m));
      const double z = terrain_.height(p) + rough * roughness_m * terrain_.bumps(p);
      tile.mesh.addVertex(Eigen::Vector3d(p.x(), p.y(), z) - tile.origin);
    }
  }
  const auto vertex = [&](int x, int y) { return static_cast<std::uint32_t>(y * kSide + x); };
  for (int y = 0; y < kGrid; ++y) {
    for (int x = 0; x < kGrid; ++x) {
      const bool road = beside_road_m[vertex(x, y)] < 0.0 && beside_road_m[vertex(x + 1, y + 1)] < 0.0;
      const Material material = road ? Material::kAsphalt : groundMaterial(kind);
      tile.mesh.addTriangle(vertex(x, y), vertex(x + 1, y), vertex(x + 1, y + 1), material);
      tile.mesh.addTriangle(vertex(x, y), vertex(x + 1, y + 1), vertex(x, y + 1), material);
    }
  }
  return tile;
}

}  // namespace fail_aware
