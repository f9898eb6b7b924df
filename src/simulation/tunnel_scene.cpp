#include "simulation/tunnel_scene.hpp"

#include <algorithm>
#include <cmath>

namespace fail_aware {

namespace {

constexpr double kFootway_m = 1.0;
constexpr double kWallHeight_m = 3.6, kVaultHeight_m = 6.0;
constexpr double kNicheSpacing_m = 150.0, kNicheLength_m = 4.0, kNicheDepth_m = 1.5;
constexpr double kStep_m = 5.0;

void addTube(SceneChunk& chunk, double from_m, double to_m, double side, double wall_m) {
  const double edge = wall_m - kFootway_m;
  chunk.addRibbon(from_m, to_m, kStep_m, {side * edge, -0.1}, {side * edge, 0.18}, Material::kConcrete);
  chunk.addRibbon(from_m, to_m, kStep_m, {side * edge, 0.18}, {side * wall_m, 0.18}, Material::kConcrete);
  chunk.addRibbon(from_m, to_m, kStep_m, {side * wall_m, -0.2}, {side * wall_m, kWallHeight_m}, Material::kConcrete);
  chunk.addRibbon(from_m, to_m, kStep_m, {side * wall_m, kWallHeight_m}, {side * 0.5 * wall_m, 0.9 * kVaultHeight_m},
                  Material::kConcrete);
  chunk.addRibbon(from_m, to_m, kStep_m, {side * 0.5 * wall_m, 0.9 * kVaultHeight_m}, {0.0, kVaultHeight_m},
                  Material::kConcrete);
}

void addNiche(SceneChunk& chunk, double s, double side, double wall_m) {
  const double back = side * (wall_m + kNicheDepth_m);
  const double end = s + kNicheLength_m;
  chunk.addRibbon(s, end, kNicheLength_m, {back, -0.2}, {back, kWallHeight_m}, Material::kConcrete);
  chunk.addRibbon(s, end, kNicheLength_m, {side * wall_m, 0.18}, {back, 0.18}, Material::kConcrete);
  for (double along : {s, end}) {
    chunk.mesh.addQuad(chunk.place(along, side * wall_m, -0.2).translation(),
                       chunk.place(along, back, -0.2).translation(),
                       chunk.place(along, back, kWallHeight_m).translation(),
                       chunk.place(along, side * wall_m, kWallHeight_m).translation(), Material::kConcrete);
  }
}

void addPortal(SceneChunk& chunk, double s) {
  const double wall = chunk.halfWidth(s) + kFootway_m;
  for (double side : {-1.0, 1.0}) {
    chunk.mesh.addBox(chunk.place(s, side * (wall + 6.0), -1.0), {1.0, 12.0, 9.5}, Material::kConcrete);
  }
  chunk.mesh.addBox(chunk.place(s, 0.0, kVaultHeight_m), {1.0, 2.0 * wall, 2.5}, Material::kConcrete);
}

}  // namespace

void buildTunnel(SceneChunk& chunk) {
  const double length = chunk.end_m() - chunk.begin_m();
  const auto tunnelAt = [&](double s) { return chunk.plan().kindAt(s) == SceneKind::kTunnel; };
  if (!tunnelAt(chunk.begin_m() - 0.5 * length)) addPortal(chunk, chunk.begin_m());
  if (!tunnelAt(chunk.end_m() + 0.5 * length)) addPortal(chunk, chunk.end_m());
  const double wall = chunk.halfWidth(0.5 * (chunk.begin_m() + chunk.end_m())) + kFootway_m;
  for (double side : {-1.0, 1.0}) {
    double from = chunk.begin_m();
    // a niche lies within one chunk: the chunks' length divides the niches' spacing
    chunk.every(kNicheSpacing_m, [&](double s, std::int64_t) {
      const double niche = s + (side > 0.0 ? 5.0 : 12.0);
      if (niche + kNicheLength_m > chunk.end_m()) return;
      addTube(chunk, from, niche, side, wall);
      addNiche(chunk, niche, side, wall);
      from = niche + kNicheLength_m;
    });
    addTube(chunk, from, chunk.end_m(), side, wall);
    chunk.every(50.0, [&](double s, std::int64_t) {  // exit signs
      chunk.mesh.addBox(chunk.place(s + 3.0, side * (wall - 0.06), 1.4), {0.5, 0.1, 0.35}, Material::kSign);
    });
  }
}

}  // namespace fail_aware
