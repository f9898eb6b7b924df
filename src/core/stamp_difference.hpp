// The time between two stamps, in whole microseconds.
//
// Current wall-clock seconds in a double have a resolution of 0.24 us. Registration makes decisions (use this point,
// use this seed, iterate again), so such a rounding difference grows to centimetres within some hundred sweeps. With
// rounded differences the same drive gives the same bits whatever the clock's zero is: a folder that begins at 0, the
// bag made from it, the live graph.
// 1 us is 25 um at 25 m/s. The stamps themselves must be whole microseconds, as KITTI's and kitti2bag's are.
#pragma once

#include <cmath>
#include <cstddef>

namespace fail_aware {

/// Stamps are whole microseconds; sums of their differences are not exactly.
inline constexpr double kStampTolerance_s = 1e-6;

/// Period of a spinning lidar until its stamps give a better value.
inline constexpr double kUsualPeriod_s = 0.1;

/// Shortest period of a sweep: no known head rotates faster than 50 Hz.
inline constexpr double kShortestPeriod_s = 0.02;

/// Longest period of a sweep: no known head rotates slower.
inline constexpr double kLongestPeriod_s = 1.0;

/// Number of intervals whose median is the usual interval.
inline constexpr std::size_t kUsualIntervals = 11;

/// A longer interval between two sweeps means that sweeps are missing; a search around the prediction may then fail.
inline constexpr double kLongInterval_s = 0.25;

/// After a longer gap the motion before it says nothing of the motion at its end: the driver may have done anything.
inline constexpr double kLongGap_s = 1.5;

inline double wholeMicroseconds(double time_s) { return std::round(time_s * 1e6) / 1e6; }

inline double secondsBetween(double from_s, double to_s) { return wholeMicroseconds(to_s - from_s); }

}  // namespace fail_aware
