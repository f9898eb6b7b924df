// Error against protection level (the bound that the monitor gives for the horizontal error), in the regions of the
// Stanford diagram used for integrity monitoring. A: alert limit.
//
//                     protection level < A     protection level >= A
// error <= level      nominal                  unavailable
// level < error < A   misleading               -
// level < error >= A  hazardous (< A)          unavailable, misleading
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace fail_aware {

enum class IntegrityRegion : std::size_t {
  kNominal = 0,
  kMisleading,
  kHazardous,
  kUnavailable,
  kUnavailableMisleading
};
constexpr std::size_t kIntegrityRegions = 5;

const char* toString(IntegrityRegion region);

IntegrityRegion integrityRegion(double error_m, double protection_level_m, double alert_limit_m);

struct ErrorAndLevel {
  double error_m = 0.0, protection_level_m = 0.0;
};

std::array<std::size_t, kIntegrityRegions> stanfordCounts(const std::vector<ErrorAndLevel>& pairs,
                                                          double alert_limit_m);

}  // namespace fail_aware
