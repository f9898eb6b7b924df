// The unit of a file of sweep stamps. Lidars turn 1 to 50 times a second, so the steps between the stamps show the
// unit.
#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "core/io/input_error.hpp"
#include "core/moving_median.hpp"
#include "core/stamp_difference.hpp"

namespace fail_aware {

/// Throws InputError, naming `path` and the likely unit, if the median step is that of a lidar in ms, us or ns.
inline void requireSeconds(const std::string& path, const std::vector<double>& stamps) {
  if (stamps.size() < 3) return;
  MovingMedian steps(stamps.size());
  for (std::size_t i = 1; i < stamps.size(); ++i) steps.add(std::abs(stamps[i] - stamps[i - 1]));
  for (const auto& [unit, per_s] :
       {std::pair("milliseconds", 1000L), {"microseconds", 1000000L}, {"nanoseconds", 1000000000L}}) {
    const double step_s = steps.median() / static_cast<double>(per_s);
    if (step_s < kShortestPeriod_s || step_s > kLongestPeriod_s) continue;
    throw InputError(path + ": the stamps are " + std::to_string(std::lround(steps.median())) +
                     " apart (median), so they are probably in " + unit + "; seconds are needed: divide them by " +
                     std::to_string(per_s));
  }
}

}  // namespace fail_aware
