// The time between two stamps, in whole microseconds.
//
// Seconds of today's clocks in a double have steps of 0.24 us. Registration decides (this point, this seed, one more
// iteration), so such a difference grows to centimetres within some hundred sweeps. Rounded, the same drive gives the
// same bits whatever its clock's zero is: a folder that begins at 0, the bag made of it, the live graph.
// 1 us is 25 um at 25 m/s. Stamps themselves must be of whole microseconds for this, as KITTI's and kitti2bag's are.
#pragma once

#include <cmath>
#include <cstddef>

namespace fail_aware {

/// Stamps are of whole microseconds, sums of differences not quite.
inline constexpr double kStampTolerance_s = 1e-6;

/// Of spinning lidars, until their stamps tell.
inline constexpr double kUsualPeriod_s = 0.1;

/// Of a sweep: no head that turns slower is known.
inline constexpr double kLongestPeriod_s = 1.0;

/// Intervals, whose median is the usual one.
inline constexpr std::size_t kUsualIntervals = 11;

/// Longer than this between two sweeps: some are missing, and a search by the prediction alone may fail.
inline constexpr double kLongInterval_s = 0.25;

inline double wholeMicroseconds(double time_s) { return std::round(time_s * 1e6) / 1e6; }

inline double secondsBetween(double from_s, double to_s) { return wholeMicroseconds(to_s - from_s); }

}  // namespace fail_aware
