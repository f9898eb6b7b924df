// The highway: rails, a barrier in the middle, some noise walls, gantries, bridges, bushes and trees on the banks.
// Adds the objects along the chunk's part of the road; no failure modes; cost: about 1000 triangles in 25 m.
#pragma once

#include "simulation/scene_chunk.hpp"

namespace fail_aware {

void buildHighway(SceneChunk& chunk);

}  // namespace fail_aware
