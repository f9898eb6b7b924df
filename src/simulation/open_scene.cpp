#include "simulation/open_scene.hpp"

namespace fail_aware {

namespace {

enum OpenSort : std::uint64_t { kLoneTrees = 500, kBales };

}  // namespace

void buildOpen(SceneChunk& chunk) {
  for (double side : {-1.0, 1.0}) {
    chunk.every(50.0, [&](double s, std::int64_t) {
      addPost(chunk.mesh, chunk.place(s, side * (chunk.halfWidth(s) + 0.8)), 1.0, 0.12, Material::kSign);
    });
  }
  chunk.every(90.0, [&](double s, std::int64_t index) {
    RandomStream random = chunk.random(kLoneTrees, index);
    const double lateral = random.sign() * random.uniform(30.0, 80.0);
    if (chunk.isClear(s, lateral, 20.0)) {
      addTree(chunk.mesh, chunk.place(s, lateral), random.uniform(6.0, 10.0), 2.0, 80, random);
    }
  });
  chunk.every(70.0, [&](double s, std::int64_t index) {
    RandomStream random = chunk.random(kBales, index);
    const double lateral = random.sign() * random.uniform(15.0, 60.0);
    if (random.chance(0.4) && chunk.isClear(s, lateral, 8.0)) {
      addPost(chunk.mesh, chunk.place(s, lateral), 1.2, 1.3, Material::kGrass);
    }
  });
}

}  // namespace fail_aware
