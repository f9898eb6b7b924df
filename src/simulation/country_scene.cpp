#include "simulation/country_scene.hpp"

#include <cmath>

namespace fail_aware {

namespace {

enum CountrySort : std::uint64_t { kTrees = 200, kWoods, kHedges, kFarms, kBushes, kFences };

constexpr double kStretch_m = 60.0;  // length of a hedge, fence, wood or gap

/// Adds what borders one side of the road, stretch by stretch.
void addStretch(SceneChunk& chunk, double side) {
  chunk.every(5.0, [&](double s, std::int64_t index) {
    const auto stretch = static_cast<std::int64_t>(std::floor(s / kStretch_m));
    RandomStream choice = chunk.random(kHedges, 2 * stretch + (side > 0.0));
    const double kind = choice.uniform();
    RandomStream random = chunk.random(kBushes, 2 * index + (side > 0.0));
    const double edge = chunk.halfWidth(s);
    if (random.chance(0.5)) {  // tall grass, a shrub
      const double lateral = side * (edge + random.uniform(1.2, 2.4));
      if (chunk.isClear(s, lateral, 0.8)) {
        addBush(chunk.mesh, chunk.place(s, lateral), random.uniform(0.25, 0.5), 20, random);
      }
    }
    if (kind < 0.25) {  // a hedge
      if (!chunk.isClear(s, side * (edge + 3.0), 1.0)) return;
      for (int lump = 0; lump < 5; ++lump) {
        const double lateral = side * (edge + 3.0 + random.uniform(-0.2, 0.2));
        const Eigen::Vector3d size(random.uniform(0.9, 1.4), random.uniform(0.6, 1.1), random.uniform(1.1, 1.8));
        chunk.mesh.addFrustum(chunk.place(s + lump + random.uniform(-0.2, 0.2), lateral), size, 0.8, 0.6,
                              Material::kFoliage);
      }
    } else if (kind < 0.45) {  // a wood
      for (int row = 0; row < 3; ++row) {
        const double lateral = side * (edge + 6.0 + 5.0 * row + random.uniform(-2.0, 2.0));
        const double along = s + random.uniform(-2.0, 2.0);
        if (!chunk.isClear(along, lateral, 3.0)) continue;
        addTree(chunk.mesh, chunk.place(along, lateral), random.uniform(8.0, 15.0), random.uniform(1.5, 2.6), 60,
                random);
        if (random.chance(0.6)) {  // undergrowth
          addBush(chunk.mesh, chunk.place(along + 1.5, lateral + random.uniform(-1.5, 1.5)), random.uniform(0.4, 1.1),
                  30, random);
        }
      }
    } else if (kind < 0.65) {  // a fence
      const double lateral = side * (edge + 4.0);
      if (!chunk.isClear(s, lateral, 1.0)) return;
      addPost(chunk.mesh, chunk.place(s + random.uniform(-0.6, 0.6), lateral), random.uniform(1.0, 1.4), 0.12,
              Material::kBark);
      chunk.mesh.addBox(chunk.place(s + 2.5, lateral, 0.75), {5.0, 0.04, 0.12}, Material::kBark);
    } else if (random.chance(0.3)) {
      const double lateral = side * (edge + random.uniform(2.5, 12.0));
      if (chunk.isClear(s, lateral, 1.5)) {
        addBush(chunk.mesh, chunk.place(s, lateral), random.uniform(0.5, 1.3), 40, random);
      }
    }
  });
}

void addFarms(SceneChunk& chunk) {
  chunk.every(110.0, [&](double s, std::int64_t index) {
    RandomStream random = chunk.random(kFarms, index);
    if (!random.chance(0.7)) return;
    const double side = random.sign();
    const double lateral = side * (chunk.halfWidth(s) + random.uniform(14.0, 30.0));
    const double length = random.uniform(12.0, 24.0), depth = random.uniform(8.0, 12.0);
    if (!chunk.isClear(s, lateral, 12.0)) return;
    Place place = chunk.place(s, lateral);
    place.linear() *= Eigen::AngleAxisd(random.uniform(-0.6, 0.6), Eigen::Vector3d::UnitZ()).toRotationMatrix();
    addShed(chunk.mesh, place, length, depth, random.uniform(4.0, 7.0));
    if (chunk.isClear(s + 22.0, lateral, 10.0)) addShed(chunk.mesh, chunk.place(s + 24.0, lateral), 9.0, 7.0, 3.5);
  });
}

}  // namespace

void buildCountry(SceneChunk& chunk) {
  for (double side : {-1.0, 1.0}) {
    addStretch(chunk, side);
    chunk.every(4.0, [&](double s, std::int64_t) {  // rails on the outside of bends
      if (chunk.curvature(s) * side > -0.003) return;
      const double lateral = side * (chunk.halfWidth(s) + 0.9);
      addPost(chunk.mesh, chunk.place(s, lateral), 0.75, 0.12, Material::kMetal);
      chunk.addRibbon(s, s + 4.0, 2.0, {lateral, 0.45}, {lateral, 0.75}, Material::kMetal);
    });
    chunk.every(50.0, [&](double s, std::int64_t) {
      const double lateral = side * (chunk.halfWidth(s) + 0.7);
      addPost(chunk.mesh, chunk.place(s, lateral), 1.0, 0.12, Material::kSign);
    });
  }
  addFarms(chunk);
  chunk.every(17.0, [&](double s, std::int64_t index) {
    RandomStream random = chunk.random(kTrees, index);
    const double side = random.sign();
    const double lateral = side * (chunk.halfWidth(s) + random.uniform(4.0, 30.0));
    if (!chunk.isClear(s, lateral, 2.5)) return;
    addTree(chunk.mesh, chunk.place(s, lateral), random.uniform(6.0, 13.0), random.uniform(1.5, 3.0), 90, random);
  });
  chunk.every(45.0, [&](double s, std::int64_t) {
    const double lateral = chunk.halfWidth(s) + 7.5;
    if (chunk.isClear(s, lateral, 2.0)) {
      chunk.mesh.addPole(chunk.place(s, lateral, -0.5).translation(), 0.14, 9.0, 7, Material::kBark);
    }
  });
  chunk.every(180.0, [&](double s, std::int64_t) {
    addTrafficSign(chunk.mesh, chunk.place(s + 11.0, -(chunk.halfWidth(s) + 1.4)), 0.8);
  });
}

}  // namespace fail_aware
