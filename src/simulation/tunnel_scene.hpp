// The tunnel: smooth walls and a vault, a footway on both sides, a lay-by and a sign now and then. Little of it tells
// the vehicle's motion along the axis: that is the point.
// Adds what stands along the chunk's part of the road; no failure modes; cost: about 200 triangles in 25 m.
#pragma once

#include "simulation/scene_chunk.hpp"

namespace fail_aware {

void buildTunnel(SceneChunk& chunk);

}  // namespace fail_aware
