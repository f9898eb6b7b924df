#include "simulation/scene_objects.hpp"

#include <algorithm>
#include <cmath>

namespace fail_aware {

namespace {

Place at(const Place& place, double x, double y, double z) { return place * Eigen::Translation3d(x, y, z); }

void addLeaves(Mesh& mesh, const Eigen::Vector3d& centre, const Eigen::Vector3d& radii, int leaves, double leaf_size,
               RandomStream& random) {
  for (int i = 0; i < leaves; ++i) {
    // uniform in the ball, by rejection
    Eigen::Vector3d p;
    do {
      p = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    } while (p.squaredNorm() > 1.0);
    const Eigen::Vector3d middle = centre + radii.cwiseProduct(p);
    Eigen::Vector3d corners[3];
    for (Eigen::Vector3d& corner : corners) {
      corner = middle + leaf_size * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    }
    const std::uint32_t first = mesh.addVertex(corners[0]);
    mesh.addVertex(corners[1]);
    mesh.addVertex(corners[2]);
    mesh.addTriangle(first, first + 1, first + 2, Material::kFoliage);
  }
}

}  // namespace

void addHouse(Mesh& mesh, const Place& place, double length, double depth, double height, RandomStream& random) {
  const double side = depth > 0.0 ? 1.0 : -1.0;
  const double body = std::abs(depth);
  constexpr double kBelow = 1.5;  // depth below the ground, which may slope
  mesh.addBox(at(place, 0.0, 0.5 * depth, -kBelow), {length, body, height + kBelow}, Material::kWall);
  mesh.addFrustum(at(place, 0.0, 0.5 * depth, height), {length + 0.5, body + 0.6, 0.3 * body}, 1.0, 0.05,
                  Material::kConcrete);
  // plinth, and the parts that stand out of the front or lie in it
  mesh.addBox(at(place, 0.0, -0.04 * side, -kBelow), {length, 0.08, kBelow + 0.6}, Material::kConcrete);
  constexpr double kFloor = 3.0;
  const int floors = std::max(1, static_cast<int>(height / kFloor));
  const int axes = std::max(1, static_cast<int>(length / 3.2));
  const int door = static_cast<int>(random.uniform() * axes);
  const bool balconies = random.chance(0.4);
  const bool shutters = random.chance(0.5);
  for (int axis = 0; axis < axes; ++axis) {
    const double x = length * ((axis + 0.5) / axes - 0.5);
    for (int floor = 0; floor < floors; ++floor) {
      const double z = kFloor * floor;
      if (floor == 0 && axis == door) {
        mesh.addBox(at(place, x - 0.75, -0.15 * side, 0.0), {0.25, 0.3, 2.4}, Material::kWall);
        mesh.addBox(at(place, x + 0.75, -0.15 * side, 0.0), {0.25, 0.3, 2.4}, Material::kWall);
        mesh.addBox(at(place, x, -0.4 * side, 2.4), {2.0, 0.8, 0.15}, Material::kConcrete);
        continue;
      }
      mesh.addBox(at(place, x, -0.005 * side, z + 1.0), {1.1, 0.03, 1.4}, Material::kGlass);
      mesh.addBox(at(place, x, -0.1 * side, z + 0.9), {1.3, 0.2, 0.08}, Material::kConcrete);
      if (shutters) {
        mesh.addBox(at(place, x - 0.85, -0.04 * side, z + 1.0), {0.55, 0.06, 1.4}, Material::kPaint);
        mesh.addBox(at(place, x + 0.85, -0.04 * side, z + 1.0), {0.55, 0.06, 1.4}, Material::kPaint);
      }
      if (balconies && floor > 0 && axis % 2 == 0) {
        mesh.addBox(at(place, x, -0.55 * side, z), {2.4, 1.1, 0.18}, Material::kConcrete);
        mesh.addBox(at(place, x, -1.08 * side, z), {2.4, 0.05, 1.0}, Material::kMetal);
      }
    }
  }
  if (random.chance(0.6)) {  // a rain pipe
    mesh.addPole(place * Eigen::Vector3d(0.47 * length, -0.08 * side, 0.0), 0.06, height, 6, Material::kMetal);
  }
}

void addShed(Mesh& mesh, const Place& place, double length, double depth, double height) {
  mesh.addBox(at(place, 0.0, 0.0, -1.5), {length, depth, height + 1.5}, Material::kWall);
  mesh.addFrustum(at(place, 0.0, 0.0, height), {length + 0.6, depth + 0.8, 0.3 * depth}, 1.0, 0.05,
                  Material::kConcrete);
  mesh.addBox(at(place, 0.25 * length, -0.5 * depth, 0.0), {3.0, 0.2, 2.6}, Material::kMetal);
}

void addVehicle(Mesh& mesh, const Place& place, VehicleShape shape) {
  const auto wheels = [&](double front, double rear, double width, double radius) {
    for (double x : {front, rear}) {
      for (double y : {-0.5 * width, 0.5 * width}) {
        mesh.addBox(at(place, x, y, 0.0), {1.6 * radius, 0.2, 2.0 * radius}, Material::kRubber);
      }
    }
  };
  switch (shape) {
    case VehicleShape::kCar:
      mesh.addFrustum(at(place, 0.0, 0.0, 0.22), {4.4, 1.78, 0.62}, 0.98, 0.94, Material::kPaint);
      mesh.addFrustum(at(place, -0.25, 0.0, 0.84), {2.7, 1.6, 0.58}, 0.62, 0.8, Material::kGlass);
      mesh.addBox(at(place, -0.3, 0.0, 1.41), {1.65, 1.28, 0.04}, Material::kPaint);
      wheels(1.35, -1.3, 1.66, 0.31);
      return;
    case VehicleShape::kVan:
      mesh.addFrustum(at(place, 0.0, 0.0, 0.28), {5.2, 1.95, 0.8}, 1.0, 0.98, Material::kPaint);
      mesh.addFrustum(at(place, -0.45, 0.0, 1.08), {4.3, 1.9, 1.0}, 0.92, 0.9, Material::kPaint);
      wheels(1.6, -1.6, 1.8, 0.33);
      return;
    case VehicleShape::kTruck:
      mesh.addBox(at(place, 4.6, 0.0, 0.5), {2.0, 2.4, 2.6}, Material::kPaint);
      mesh.addBox(at(place, -1.2, 0.0, 1.1), {9.0, 2.5, 2.7}, Material::kPaint);
      mesh.addBox(at(place, -0.5, 0.0, 0.6), {9.5, 0.9, 0.5}, Material::kMetal);
      wheels(4.4, -3.6, 2.2, 0.5);
      return;
  }
}

void addTree(Mesh& mesh, const Place& place, double height, double crown_radius, int leaves, RandomStream& random) {
  const double crown_height = 0.65 * height;
  const double trunk_radius = 0.02 * height + 0.06;
  mesh.addPole(place * Eigen::Vector3d(0.0, 0.0, -0.5), trunk_radius, height - 0.5 * crown_height + 0.5, 7,
               Material::kBark);
  addLeaves(mesh, place * Eigen::Vector3d(0.0, 0.0, height - 0.5 * crown_height),
            {crown_radius, crown_radius, 0.5 * crown_height}, leaves, 0.28, random);
}

void addBush(Mesh& mesh, const Place& place, double radius, int leaves, RandomStream& random) {
  addLeaves(mesh, place * Eigen::Vector3d(0.0, 0.0, 0.6 * radius), {radius, radius, 0.8 * radius}, leaves,
            0.2 * std::sqrt(radius), random);
}

void addLamp(Mesh& mesh, const Place& place, double height, double reach) {
  mesh.addPole(place * Eigen::Vector3d(0.0, 0.0, -0.5), 0.08, height + 0.5, 7, Material::kMetal);
  mesh.addBox(at(place, 0.0, 0.5 * reach, height), {0.1, std::abs(reach), 0.1}, Material::kMetal);
  mesh.addPole(place * Eigen::Vector3d(0.0, 0.0, -0.5), 0.14, 1.5, 7, Material::kMetal);
}

void addTrafficSign(Mesh& mesh, const Place& place, double size) {
  mesh.addPole(place * Eigen::Vector3d(0.0, 0.0, -0.5), 0.04, 2.3 + size + 0.5, 6, Material::kMetal);
  mesh.addBox(at(place, -0.06, 0.0, 2.2), {0.03, size, size}, Material::kSign);
}

void addPost(Mesh& mesh, const Place& place, double height, double width, Material material) {
  mesh.addBox(at(place, 0.0, 0.0, -0.4), {width, width, height + 0.4}, material);
}

}  // namespace fail_aware
