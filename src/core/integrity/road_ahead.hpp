// What the last sweeps see of the road ahead (registration/look_ahead.hpp), and whether a weak stretch begins there.
//
// One sweep sees a stretch by some dozen points, and between two rails the ratio of a sweep is 0.0001 or 0.04 by
// chance. Therefore the mean of the last nine sweeps counts, where each ratio is limited to that of a weak sweep:
// behind the mouth of a tunnel all are weak. On 52 simulated drives without a tunnel (highway to town, with faults;
// `fail_aware_benchmark --seeds 80501` to 80504) no sweep is then called weak ahead, with the median of five 43 are.
// Four mouths are noticed 0.2 to 0.5 s later, at 10 Hz; at 5 Hz it is twice as long.
// Cost: below 1 us a sweep.
#pragma once

#include <cstddef>
#include <deque>

#include "core/moving_median.hpp"
#include "core/types/information_ahead.hpp"

namespace fail_aware {

class RoadAhead {
 public:
  /// Of the newest sweep. An invalid one counts as a sweep that sees nothing.
  void add(const InformationAhead& ahead);
  /// The median of five sweeps.
  InformationAhead ahead() const;
  /// True: the mean ratio ahead is below a fifth of `min_information_ratio`, the limit for a weak sweep here. A fifth,
  /// because posts and trees beside the road do not count ahead.
  bool isWeak(double min_information_ratio) const;

 private:
  static constexpr std::size_t kSweeps = 5, kWeakSweeps = 9, kFewestKnown = 5;
  MovingMedian ratio_{kSweeps}, distance_m_{kSweeps};
  std::deque<InformationAhead> last_;
};

}  // namespace fail_aware
