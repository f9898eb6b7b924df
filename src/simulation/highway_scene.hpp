// The highway: rails, a barrier in the middle, noise walls in places, gantries, bridges, bushes and trees on the banks.
// Adds what stands along the chunk's part of the road; no failure modes; cost: about 1000 triangles in 25 m.
#pragma once

#include "simulation/scene_chunk.hpp"

namespace fail_aware {

void buildHighway(SceneChunk& chunk);

}  // namespace fail_aware
