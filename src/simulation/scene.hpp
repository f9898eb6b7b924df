// The world around the vehicle, in tiles. Tiles are created ahead and deleted behind, so that memory does not grow with
// the drive's length.
//
// Tiles: square cells of ground (within about 130 m of the vehicle) and chunks of roadside (25 m of road each, from
// 140 m behind to 160 m ahead). Each has a mesh relative to its own origin. update() returns the created and the
// deleted tiles in an order that depends only on the arguments. Cost: about 1 ms a tile, a few tiles a second.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "simulation/mesh.hpp"
#include "simulation/road.hpp"
#include "simulation/terrain.hpp"

namespace fail_aware {

struct SceneTile {
  std::int64_t id = 0;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< world, m
  Mesh mesh;
};

struct SceneChange {
  std::vector<SceneTile> added;
  std::vector<std::int64_t> removed;
};

class Scene {
 public:
  Scene(std::uint64_t seed, const ScenePlan& plan);

  /// `position`, `s_m`: the vehicle's position. Extends the road to 400 m ahead of it.
  SceneChange update(const Eigen::Vector2d& position, double s_m);

  const Road& road() const { return road_; }
  const Terrain& terrain() const { return terrain_; }
  std::size_t tiles() const { return cells_.size() + chunks_.size(); }

 private:
  using Cell = std::pair<std::int64_t, std::int64_t>;
  void updateChunks(double s_m, SceneChange& change);
  void updateGround(const Eigen::Vector2d& position, double s_m, SceneChange& change);
  SceneTile makeChunk(std::int64_t index) const;
  SceneTile makeGround(const Cell& cell, double s_m) const;

  std::uint64_t seed_;
  Terrain terrain_;
  Road road_;
  std::set<std::int64_t> chunks_;
  std::set<Cell> cells_;
};

}  // namespace fail_aware
