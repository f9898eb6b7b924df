#include "simulation/town_scene.hpp"

#include <algorithm>
#include <cmath>

namespace fail_aware {

namespace {

enum TownSort : std::uint64_t { kHouses = 100, kParked, kLamps, kStreetTrees, kStreetSigns, kBins, kHouseHeight };

constexpr double kSlot_m = 19.0;  // a house and its gap
constexpr double kPavement_m = 2.6;
constexpr double kKerb_m = 0.12;

void addHouses(SceneChunk& chunk) {
  chunk.every(kSlot_m, [&](double s, std::int64_t index) {
    for (double side : {-1.0, 1.0}) {
      RandomStream random = chunk.random(kHouses, 2 * index + (side > 0.0));
      const double middle = s + 0.5 * kSlot_m;
      const double set_back = random.chance(0.7) ? random.uniform(0.0, 0.8) : random.uniform(2.0, 5.0);
      const double front = chunk.halfWidth(middle) + kPavement_m + set_back;
      const double length = random.chance(0.5) ? kSlot_m + 0.2 : random.uniform(10.0, kSlot_m - 2.5);
      const double depth = random.uniform(8.0, 12.0);
      const double height = 3.0 * std::floor(random.uniform(2.0, 5.99)) + 0.4;
      bool clear = true;
      for (double along : {-0.5, -0.25, 0.0, 0.25, 0.5}) {
        for (double back : {0.0, 0.5, 1.0}) {
          clear = clear && chunk.isClear(middle + along * length, side * (front + back * depth), 1.2);
        }
      }
      const bool house = clear && random.chance(0.86);
      if (house) {
        addHouse(chunk.mesh, chunk.place(middle, side * front), length, side * depth, height, random);
      } else if (chunk.isClear(middle, side * front, 1.2)) {  // a garden behind a hedge or wall
        const bool hedge = random.chance(0.5);
        const Material material = hedge ? Material::kFoliage : Material::kWall;
        const double thickness = hedge ? 0.8 : 0.25, top = hedge ? 1.5 : 1.1;
        chunk.mesh.addBox(chunk.place(middle, side * front, -0.5), {12.0, thickness, top + 0.5}, material);
        const double behind = side * (front + 4.0);
        if (chunk.isClear(middle + 3.0, behind, 2.0)) {
          addTree(chunk.mesh, chunk.place(middle + 3.0, behind), random.uniform(6.0, 10.0), 2.4, 90, random);
        }
      }
    }
  });
}

void addPavements(SceneChunk& chunk) {
  const double s = 0.5 * (chunk.begin_m() + chunk.end_m());
  const double edge = chunk.halfWidth(s);
  for (double side : {-1.0, 1.0}) {
    if (!chunk.isClear(s, side * (edge + kPavement_m), 0.5)) continue;
    chunk.addRibbon(chunk.begin_m(), chunk.end_m(), 2.5, {side * edge, -0.1}, {side * edge, kKerb_m},
                    Material::kConcrete);
    chunk.addRibbon(chunk.begin_m(), chunk.end_m(), 2.5, {side * edge, kKerb_m}, {side * (edge + kPavement_m), kKerb_m},
                    Material::kPavement);
  }
}

void addParkedCars(SceneChunk& chunk) {
  chunk.every(6.2, [&](double s, std::int64_t index) {
    for (double side : {-1.0, 1.0}) {
      RandomStream random = chunk.random(kParked, 2 * index + (side > 0.0));
      if (!random.chance(0.5) || std::abs(chunk.curvature(s)) > 0.01) continue;
      const double lateral = side * (chunk.halfWidth(s) - 1.05 + random.uniform(-0.15, 0.1));
      Place place = chunk.place(s + random.uniform(-0.5, 0.5), lateral);
      if (side > 0.0) place.linear() *= Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      addVehicle(chunk.mesh, place, random.chance(0.15) ? VehicleShape::kVan : VehicleShape::kCar);
    }
  });
}

}  // namespace

void buildTown(SceneChunk& chunk) {
  addHouses(chunk);
  addPavements(chunk);
  addParkedCars(chunk);
  chunk.every(27.0, [&](double s, std::int64_t index) {
    const double side = index % 2 == 0 ? 1.0 : -1.0;
    const double lateral = side * (chunk.halfWidth(s) + 0.5);
    if (chunk.isClear(s, lateral, 0.2)) addLamp(chunk.mesh, chunk.place(s, lateral), 6.5, -side * 1.6);
  });
  chunk.every(15.0, [&](double s, std::int64_t index) {
    RandomStream random = chunk.random(kStreetTrees, index);
    const double side = random.sign();
    const double lateral = side * (chunk.halfWidth(s) + 1.1);
    if (!random.chance(0.35) || !chunk.isClear(s, lateral, 0.8)) return;
    addTree(chunk.mesh, chunk.place(s, lateral), random.uniform(5.0, 8.0), random.uniform(1.2, 1.9), 70, random);
  });
  chunk.every(40.0, [&](double s, std::int64_t index) {
    RandomStream random = chunk.random(kStreetSigns, index);
    const double side = random.sign();
    const double lateral = side * (chunk.halfWidth(s + 7.0) + 0.4);
    if (!chunk.isClear(s + 7.0, lateral, 0.1)) return;
    addTrafficSign(chunk.mesh, chunk.place(s + 7.0, lateral), 0.6);
    addPost(chunk.mesh, chunk.place(s + 9.0, side * (chunk.halfWidth(s + 9.0) + 1.8)), 1.1, 0.6, Material::kPaint);
  });
}

}  // namespace fail_aware
