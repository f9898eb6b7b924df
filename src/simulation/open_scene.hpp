// The open field: ground, a post every 50 m, a few distant trees.
// Adds the objects along the chunk's part of the road; no failure modes; cost: about 50 triangles in 25 m.
#pragma once

#include "simulation/scene_chunk.hpp"

namespace fail_aware {

void buildOpen(SceneChunk& chunk);

}  // namespace fail_aware
