// The country: trees, bushes, hedges and woods, posts, a few farms, rails on the outside of bends.
// Adds the objects along the chunk's part of the road; no failure modes; cost: about 2000 triangles in 25 m.
#pragma once

#include "simulation/scene_chunk.hpp"

namespace fail_aware {

void buildCountry(SceneChunk& chunk);

}  // namespace fail_aware
