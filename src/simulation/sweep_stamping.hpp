// A simulated sweep in the conventions of the two kinds of consumers.
//
// KITTI: stamp in the sweep's middle, times from its start, intensity 0..1; ground truth in the middle.
// Velodyne driver: stamp at the sweep's end, times relative to it (<= 0), intensity 0..255; ground truth at the end.
// A wrong time sign (fault) inverts the sign of all times. No failure modes. Cost: one copy of the sweep.
#pragma once

#include "simulation/drive_simulation.hpp"

namespace fail_aware {

Sweep kittiSweep(const SimulatedSweep& simulated);
Sweep driverSweep(const SimulatedSweep& simulated);

}  // namespace fail_aware
