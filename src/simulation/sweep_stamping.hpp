// A simulated sweep as the two kinds of consumers get it.
//
// KITTI: stamp in the sweep's middle, times from its start, intensity 0..1; truth in the middle.
// Velodyne driver: stamp at the sweep's end, times relative to that (<= 0), intensity 0..255; truth at the end.
// A wrong time sign (fault) turns all times' signs. No failure modes. Cost: one copy of the sweep.
#pragma once

#include "simulation/drive_simulation.hpp"

namespace fail_aware {

Sweep kittiSweep(const SimulatedSweep& simulated);
Sweep driverSweep(const SimulatedSweep& simulated);

}  // namespace fail_aware
