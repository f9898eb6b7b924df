// Leaves out points of a sweep, in all of its arrays alike.
#pragma once

#include <cstddef>
#include <vector>

#include "fail_aware_lidar_odometry/sweep.hpp"

namespace fail_aware {

/// The values at the kept places (ascending); an empty array stays empty.
template <class T>
void keepValues(const std::vector<std::size_t>& kept, std::vector<T>& values) {
  if (values.empty()) return;
  for (std::size_t i = 0; i < kept.size(); ++i) values[i] = values[kept[i]];
  values.resize(kept.size());
}

inline void keepPoints(const std::vector<std::size_t>& kept, Sweep& sweep) {
  keepValues(kept, sweep.points_lidar);
  keepValues(kept, sweep.intensities);
  keepValues(kept, sweep.times_s);
  keepValues(kept, sweep.rings);
}

/// Without points, as if nothing had been read; the stamp stays.
inline void clearPoints(Sweep& sweep) {
  keepPoints({}, sweep);
  sweep.time_field = TimeFieldSource();
  sweep.points_dropped = 0;
}

}  // namespace fail_aware
