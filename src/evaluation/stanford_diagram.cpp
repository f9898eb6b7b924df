#include "evaluation/stanford_diagram.hpp"

namespace fail_aware {

const char* toString(IntegrityRegion region) {
  switch (region) {
    case IntegrityRegion::kNominal: return "nominal";
    case IntegrityRegion::kMisleading: return "misleading";
    case IntegrityRegion::kHazardous: return "hazardous";
    case IntegrityRegion::kUnavailable: return "unavailable";
    case IntegrityRegion::kUnavailableMisleading: return "unavailable_misleading";
  }
  return "unknown";
}

IntegrityRegion integrityRegion(double error_m, double protection_level_m, double alert_limit_m) {
  const bool bounded = error_m <= protection_level_m;
  if (protection_level_m >= alert_limit_m) {
    return bounded ? IntegrityRegion::kUnavailable : IntegrityRegion::kUnavailableMisleading;
  }
  if (bounded) return IntegrityRegion::kNominal;
  return error_m < alert_limit_m ? IntegrityRegion::kMisleading : IntegrityRegion::kHazardous;
}

std::array<std::size_t, kIntegrityRegions> stanfordCounts(const std::vector<ErrorAndLevel>& pairs,
                                                          double alert_limit_m) {
  std::array<std::size_t, kIntegrityRegions> counts{};
  for (const ErrorAndLevel& pair : pairs) {
    ++counts[static_cast<std::size_t>(integrityRegion(pair.error_m, pair.protection_level_m, alert_limit_m))];
  }
  return counts;
}

}  // namespace fail_aware
