// The range of a ray that meets the road: the road's unevenness is too fine for the scene's triangles and shifts the
// hit along the ray instead.
//
// World frame, m. No failure modes: a ray that meets the road nearly flat keeps its range.
// Cost: three times Terrain::roadRoughness().
#pragma once

#include <Eigen/Core>

#include "simulation/ray_caster.hpp"
#include "simulation/terrain.hpp"

namespace fail_aware {

/// `hit`: where the ray meets the smooth road. Its range on the uneven road.
float rangeOnUnevenRoad(const Eigen::Vector3d& from_world, const Eigen::Vector3f& direction_world, const RayHit& hit,
                        const Terrain& terrain);

}  // namespace fail_aware
