// The tunnel: smooth walls and a vault, a footway on both sides, a few lay-bys and signs. By design almost nothing in
// it shows the vehicle's motion along the axis.
// Adds the objects along the chunk's part of the road; no failure modes; cost: about 200 triangles in 25 m.
#pragma once

#include "simulation/scene_chunk.hpp"

namespace fail_aware {

void buildTunnel(SceneChunk& chunk);

}  // namespace fail_aware
