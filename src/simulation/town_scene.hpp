// The town: houses with small gaps, pavements, parked cars, lamps, signs, some trees and hedges.
// Adds the objects along the chunk's part of the road; no failure modes; cost: about 3000 triangles in 25 m.
#pragma once

#include "simulation/scene_chunk.hpp"

namespace fail_aware {

void buildTown(SceneChunk& chunk);

}  // namespace fail_aware
