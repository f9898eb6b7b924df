// A time to failure that is calm: it falls at once, but rises by no more than 40 % a second (not in the paper).
//
// Where the scenery changes from sweep to sweep, so does the prediction: a niche in a tunnel's wall, seen for a second,
// makes it jump up and, behind the niche, down again. A planner needs the fall without delay; a rise can wait.
// Unknown: passed on, and the next time is not limited.
#pragma once

#include "fail_aware_lidar_odometry/monitor.hpp"

namespace fail_aware {

class RiseLimit {
 public:
  /// The calm time `dt_s` after the last one.
  TimeToFailure limit(const TimeToFailure& time, double dt_s, double horizon_s);
  void reset() { last_ = TimeToFailure::unknown(); }

 private:
  TimeToFailure last_;
};

}  // namespace fail_aware
