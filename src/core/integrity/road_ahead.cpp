#include "core/integrity/road_ahead.hpp"

#include <algorithm>

namespace fail_aware {

void RoadAhead::add(const InformationAhead& ahead) {
  const InformationAhead seen = ahead.isValid() ? ahead : InformationAhead();
  ratio_.add(seen.ratio);
  distance_m_.add(seen.distance_m);
  last_.push_back(seen);
  if (last_.size() > kWeakSweeps) last_.pop_front();
}

InformationAhead RoadAhead::ahead() const {
  if (ratio_.size() == 0) return {};
  return {ratio_.median(), distance_m_.median()};
}

bool RoadAhead::isWeak(double min_information_ratio) const {
  constexpr double kWeak = 0.2;
  double sum = 0.0;
  std::size_t known = 0;
  for (const InformationAhead& seen : last_) {
    if (!seen.known()) continue;
    sum += std::min(seen.ratio, min_information_ratio);
    ++known;
  }
  const bool enough = last_.size() == kWeakSweeps && known >= kFewestKnown;
  return enough && sum < kWeak * min_information_ratio * static_cast<double>(known);
}

}  // namespace fail_aware
