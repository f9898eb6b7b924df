#include "core/integrity/recent_shortest_time.hpp"

#include <algorithm>

namespace fail_aware {

namespace {

constexpr double kWindow_s = 5.0;

}  // namespace

TimeToFailure RecentShortestTime::add(const TimeToFailure& time, double dt_s) {
  if (!time.isKnown()) {
    reset();
    return time;
  }
  for (Entry& entry : recent_) entry.age_s += std::max(dt_s, 0.0);
  while (!recent_.empty() && recent_.front().age_s > kWindow_s) recent_.pop_front();
  recent_.push_back({time});
  TimeToFailure shortest = time;
  for (const Entry& entry : recent_) shortest = combine(shortest, entry.time);
  return shortest;
}

}  // namespace fail_aware
