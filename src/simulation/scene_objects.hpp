// The objects of a scene: houses, cars, trees, lamps, rails. Each function adds one to a mesh at a place.
//
// A place is a frame on the ground, x along the road, y to its left, z up. Sizes in m. No failure modes.
#pragma once

#include "simulation/mesh.hpp"
#include "simulation/random.hpp"

namespace fail_aware {

using Place = Eigen::Isometry3d;

/// `place`: the middle of the front, which faces -y (`depth` > 0) or +y (`depth` < 0). The house has windows, a door,
/// balconies and a roof.
void addHouse(Mesh& mesh, const Place& place, double length, double depth, double height, RandomStream& random);
void addShed(Mesh& mesh, const Place& place, double length, double depth, double height);

enum class VehicleShape { kCar, kVan, kTruck };
void addVehicle(Mesh& mesh, const Place& place, VehicleShape shape);

/// A trunk, and a crown of leaves scattered in an ellipsoid: pulses return from different depths.
void addTree(Mesh& mesh, const Place& place, double height, double crown_radius, int leaves, RandomStream& random);
void addBush(Mesh& mesh, const Place& place, double radius, int leaves, RandomStream& random);

/// A lamp post with an arm `reach` to the left (negative: right).
void addLamp(Mesh& mesh, const Place& place, double height, double reach);
/// A plate on a post, facing along the road.
void addTrafficSign(Mesh& mesh, const Place& place, double size);
void addPost(Mesh& mesh, const Place& place, double height, double width, Material material);

}  // namespace fail_aware
