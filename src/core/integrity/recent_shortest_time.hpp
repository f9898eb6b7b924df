// A time to failure that is calm: the shortest one of the last five seconds (not in the paper).
//
// Where the scenery changes from sweep to sweep, so does the prediction: a niche in a tunnel's wall, seen for a second,
// makes it jump up and, behind the niche, down again. A planner needs the fall without delay; a rise can wait. With
// three seconds the time jumps more often, with seven it is no calmer (58 drives).
// Unknown: passed on, and the times before it do not count. Cost: negligible.
#pragma once

#include <algorithm>
#include <deque>

#include "fail_aware_lidar_odometry/monitor.hpp"

namespace fail_aware {

class RecentShortestTime {
 public:
  /// The calm time `dt_s` after the last one.
  TimeToFailure add(const TimeToFailure& time, double dt_s) {
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
  void reset() { recent_.clear(); }

 private:
  static constexpr double kWindow_s = 5.0;
  struct Entry {
    TimeToFailure time;
    double age_s = 0.0;
  };
  std::deque<Entry> recent_;  ///< the newest last
};

}  // namespace fail_aware
