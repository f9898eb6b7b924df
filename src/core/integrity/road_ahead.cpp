#include "core/integrity/road_ahead.hpp"

#include <algorithm>

namespace fail_aware {

void RoadAhead::add(const InformationAhead& ahead) {
  const InformationAhead seen = ahead.isValid() ? ahead : InformationAhead();
  ratio_.add(seen.ratio);
  distance_m_.add(seen.distance_m);
  last_ratios_.push_back(seen.ratio);
  if (last_ratios_.size() > kWeakSweeps) last_ratios_.pop_front();
}

InformationAhead RoadAhead::ahead() const {
  if (ratio_.size() == 0) return {};
  return {ratio_.median(), distance_m_.median()};
}

bool RoadAhead::isWeak(double min_information_ratio) const {
  constexpr double kWeak = 0.2;
  if (last_ratios_.size() < kWeakSweeps) return false;
  double sum = 0.0;
  for (const double ratio : last_ratios_) sum += std::min(ratio, min_information_ratio);
  return sum < kWeak * min_information_ratio * kWeakSweeps;
}

}  // namespace fail_aware
