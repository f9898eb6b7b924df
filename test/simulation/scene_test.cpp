#include "simulation/scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace fail_aware::scene_test {
namespace {

const char* const kScenes[] = {"town", "country", "highway", "tunnel", "open", "town:150,tunnel:100,country"};

TEST(Scene, MemoryDoesNotGrowAndEveryTileGoes) {
  for (const char* name : kScenes) {
    Scene scene(3, ScenePlan::parse(name, 60.0));
    std::map<std::int64_t, std::size_t> alive;
    std::size_t most_triangles = 0, most_tiles = 0;
    for (double s = 0.0; s < 1000.0; s += 4.0) {
      const SceneChange change = scene.update(scene.road().at(s).position, s);
      for (std::int64_t id : change.removed) ASSERT_EQ(alive.erase(id), 1u) << name;
      for (const SceneTile& tile : change.added) ASSERT_TRUE(alive.emplace(tile.id, tile.mesh.triangles.size()).second);
      std::size_t triangles = 0;
      for (const auto& tile : alive) triangles += tile.second;
      most_triangles = std::max(most_triangles, triangles);
      most_tiles = std::max(most_tiles, alive.size());
    }
    EXPECT_EQ(scene.tiles(), alive.size());
    EXPECT_LT(most_tiles, 90u) << name;
    EXPECT_LT(most_triangles, 150000u) << name;
  }
}

/// Things of a car's height within 1 m of the middle of the car's lane, as text; empty: the lane is free.
std::string onLane(const Scene& scene, const SceneTile& tile, double s) {
  for (const Eigen::Vector3f& v : tile.mesh.vertices) {
    const Eigen::Vector3d p = tile.origin + v.cast<double>();
    const double above = p.z() - scene.terrain().height(p.head<2>());
    if (above < 0.3 || above > 2.5) continue;
    const double at = scene.road().project(p.head<2>(), s);
    if (std::abs(at - s) > 150.0) continue;
    const RoadPoint road = scene.road().at(at);
    const Eigen::Vector2d to_point = p.head<2>() - road.position;
    if (std::abs(to_point.dot(road.forward())) > 1.0) continue;  // beside another stretch
    if (std::abs(to_point.dot(road.left()) + scene.road().laneOffset(at)) < 1.0) {
      return "at " + std::to_string(at) + " m, " + std::to_string(above) + " m high";
    }
  }
  return {};
}

TEST(Scene, MeshesAreSoundAndTheCarsLaneIsFree) {
  for (const char* name : kScenes) {
    Scene scene(8, ScenePlan::parse(name, 60.0));
    for (double s = 0.0; s < 800.0; s += 20.0) {
      for (const SceneTile& tile : scene.update(scene.road().at(s).position, s).added) {
        for (const Triangle& t : tile.mesh.triangles) {
          ASSERT_LT(std::max({t.a, t.b, t.c}), tile.mesh.vertices.size());
        }
        for (const Eigen::Vector3f& v : tile.mesh.vertices) ASSERT_TRUE(v.allFinite());
        ASSERT_EQ(onLane(scene, tile, s), "") << name;
      }
    }
  }
}

TEST(Scene, SameSeedSameTiles) {
  const auto first = [](std::uint64_t seed) {
    Scene scene(seed, ScenePlan::parse("town", 60.0));
    return scene.update({0, 0}, 0.0).added;
  };
  const auto a = first(5), b = first(5), c = first(6);
  ASSERT_EQ(a.size(), b.size());
  bool differs = false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].id, b[i].id);
    EXPECT_EQ(a[i].mesh.vertices, b[i].mesh.vertices);
    differs = differs || i >= c.size() || a[i].mesh.vertices != c[i].mesh.vertices;
  }
  EXPECT_TRUE(differs);
}

}  // namespace
}  // namespace fail_aware::scene_test
