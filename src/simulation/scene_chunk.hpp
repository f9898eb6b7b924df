// A piece of the roadside, with functions for the scene builders to add objects.
//
// A chunk covers [begin_m, end_m) of the road's arc length; its mesh is relative to `origin` (world, m). What a builder
// adds depends only on the seed and the position along the road, so a drive can be generated chunk by chunk.
// Each kind of scene has a builder in its own file: town_scene, country_scene, highway_scene, tunnel_scene, open_scene.
#pragma once

#include <cstdint>

#include "simulation/road.hpp"
#include "simulation/scene_objects.hpp"
#include "simulation/terrain.hpp"

namespace fail_aware {

class SceneChunk {
 public:
  SceneChunk(std::uint64_t seed, const Road& road, const Terrain& terrain, double begin_m, double end_m);

  /// A separate random stream for the `index`-th object of a sort.
  RandomStream random(std::uint64_t sort, std::int64_t index) const;

  /// Calls add(s, index) for each multiple of `spacing_m` in the chunk.
  template <class Add>
  void every(double spacing_m, Add&& add) const {
    for (auto i = firstIndex(spacing_m); static_cast<double>(i) * spacing_m < end_m_; ++i) {
      add(static_cast<double>(i) * spacing_m, i);
    }
  }

  /// On the ground, `lateral_m` to the left of the road's centre line, x along the road; relative to the origin.
  Place place(double s_m, double lateral_m, double lift_m = 0.0) const;
  /// Whether no part of the road has its asphalt within `clearance_m`.
  bool isClear(double s_m, double lateral_m, double clearance_m) const;
  double halfWidth(double s_m) const { return road_.halfWidth(s_m); }
  double curvature(double s_m) const { return road_.at(s_m).curvature_per_m; }

  /// A ribbon along the road between the edges a and b (lateral, height), in steps of `step_m`.
  struct Edge {
    double lateral_m, height_m;
  };
  void addRibbon(double from_m, double to_m, double step_m, const Edge& a, const Edge& b, Material material);

  double begin_m() const { return begin_m_; }
  double end_m() const { return end_m_; }
  const Eigen::Vector3d& origin() const { return origin_; }
  const ScenePlan& plan() const { return road_.plan(); }
  Mesh mesh;

 private:
  std::int64_t firstIndex(double spacing_m) const;

  std::uint64_t seed_;
  const Road& road_;
  const Terrain& terrain_;
  double begin_m_, end_m_;
  Eigen::Vector3d origin_;
};

}  // namespace fail_aware
