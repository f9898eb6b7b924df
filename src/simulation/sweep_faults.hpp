// Faults of one sweep: pure functions of the sweep, their severity and, if they are random, a key.
//
// All arrays of a sweep keep the length of its points. makeNan deliberately breaks Sweep's promise of finite points:
// its result is for files and messages, whose readers must handle it. No failure modes. Cost: one pass over the points.
#pragma once

#include <cstdint>

#include "fail_aware_lidar_odometry/sweep.hpp"

namespace fail_aware {

/// Removes the points within +- width / 2 of straight ahead.
void blankSector(Sweep& sweep, double width_deg);
/// Removes this ratio of the rings (the same ones for the same key); needs rings.
void loseRings(Sweep& sweep, double share, std::uint64_t key);
void capRange(Sweep& sweep, double range_m);
void addNoise(Sweep& sweep, double sigma_m, std::uint64_t key);
/// Adds share * size points on the rays of existing ones, at random shorter ranges.
void addGhosts(Sweep& sweep, double share, std::uint64_t key);
/// Keeps the first `share` of the points, which are in the order of time.
void cutShort(Sweep& sweep, double share);
/// Rotates the points as if the mount tilted forward by this angle and by half of it to the right.
void tiltMount(Sweep& sweep, double angle_deg);
void makeEmpty(Sweep& sweep);
void makeNan(Sweep& sweep, double share, std::uint64_t key);

}  // namespace fail_aware
