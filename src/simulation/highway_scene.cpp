#include "simulation/highway_scene.hpp"

#include <cmath>

namespace fail_aware {

namespace {

enum HighwaySort : std::uint64_t { kBank = 300, kNoiseWall, kSigns };

constexpr double kNoiseWallStretch_m = 240.0;

void addRails(SceneChunk& chunk) {
  for (double side : {-1.0, 1.0}) {
    chunk.every(4.0, [&](double s, std::int64_t) {
      const double lateral = side * (chunk.halfWidth(s) + 0.8);
      addPost(chunk.mesh, chunk.place(s, lateral), 0.75, 0.13, Material::kMetal);
      chunk.addRibbon(s, s + 4.0, 4.0, {lateral, 0.45}, {lateral, 0.75}, Material::kMetal);
    });
    chunk.addRibbon(chunk.begin_m(), chunk.end_m(), 5.0, {side * 0.3, -0.2}, {side * 0.12, 0.85}, Material::kConcrete);
    chunk.every(50.0, [&](double s, std::int64_t) {
      addPost(chunk.mesh, chunk.place(s, side * (chunk.halfWidth(s) + 1.1)), 1.1, 0.12, Material::kSign);
    });
  }
  chunk.every(36.0, [&](double s, std::int64_t) { addLamp(chunk.mesh, chunk.place(s, 0.0), 10.0, 1.5); });
}

void addBanks(SceneChunk& chunk) {
  for (double side : {-1.0, 1.0}) {
    chunk.every(8.0, [&](double s, std::int64_t index) {
      const auto stretch = static_cast<std::int64_t>(std::floor(s / kNoiseWallStretch_m));
      const bool wall = chunk.random(kNoiseWall, 2 * stretch + (side > 0.0)).chance(0.3);
      const double edge = chunk.halfWidth(s);
      if (wall) {
        const double lateral = side * (edge + 3.5);
        chunk.addRibbon(s, s + 8.0, 4.0, {lateral, -0.5}, {lateral, 3.5}, Material::kConcrete);
        chunk.mesh.addBox(chunk.place(s, lateral, -0.5), {0.3, 0.4, 4.2}, Material::kMetal);
        return;
      }
      RandomStream random = chunk.random(kBank, 2 * index + (side > 0.0));
      const double lateral = side * (edge + random.uniform(6.0, 30.0));
      if (random.chance(0.3)) {
        addTree(chunk.mesh, chunk.place(s, lateral), random.uniform(6.0, 14.0), random.uniform(1.5, 3.0), 70, random);
      } else if (random.chance(0.5)) {
        addBush(chunk.mesh, chunk.place(s, lateral), random.uniform(0.6, 1.6), 40, random);
      }
    });
  }
}

void addBridgesAndGantries(SceneChunk& chunk) {
  chunk.every(450.0, [&](double s, std::int64_t index) {
    const double edge = chunk.halfWidth(s);
    for (double side : {-1.0, 1.0}) {
      const double lateral = side * (edge + 1.6);
      if (index % 2 == 0) {  // a bridge over the road
        chunk.mesh.addBox(chunk.place(s, lateral, -0.5), {9.0, 1.0, 6.0}, Material::kConcrete);
        chunk.mesh.addBox(chunk.place(s, side * (edge + 8.0), -0.5), {9.0, 10.0, 6.0}, Material::kConcrete);
      } else {
        chunk.mesh.addPole(chunk.place(s, lateral, -0.5).translation(), 0.25, 7.0, 8, Material::kMetal);
      }
    }
    const double length = index % 2 == 0 ? 9.0 : 0.6, thickness = index % 2 == 0 ? 1.2 : 0.6;
    chunk.mesh.addBox(chunk.place(s, 0.0, 5.3), {length, 2.0 * (edge + 2.0), thickness}, Material::kConcrete);
    if (index % 2 == 0) {
      chunk.mesh.addBox(chunk.place(s, 0.0, -0.2), {1.0, 0.8, 5.6}, Material::kConcrete);
    } else {
      chunk.mesh.addBox(chunk.place(s, -0.5 * edge, 5.6), {0.1, 5.0, 2.0}, Material::kSign);
    }
  });
}

}  // namespace

void buildHighway(SceneChunk& chunk) {
  addRails(chunk);
  addBanks(chunk);
  addBridgesAndGantries(chunk);
  chunk.every(260.0, [&](double s, std::int64_t) {
    addTrafficSign(chunk.mesh, chunk.place(s + 30.0, -(chunk.halfWidth(s) + 2.0)), 1.4);
  });
}

}  // namespace fail_aware
