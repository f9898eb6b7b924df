// What the last sweeps see of the road ahead (registration/look_ahead.hpp), and whether a weak stretch begins there.
//
// One sweep sees a stretch by some dozen points, and between two rails the ratio of a sweep is 0.0001 or 0.04 by chance.
// So the last nine sweeps count together, each that sees something up to the limit for a weak sweep: behind a mouth all
// are weak. On 52 simulated drives without a tunnel (highway to town, with faults; `fail_aware_benchmark --seeds 80501`
// to 80504) no sweep is then called weak ahead, with the median of five 43 are. Four mouths are noticed 0.2 to 0.5 s
// later, at 10 Hz; at 5 Hz it is twice as long.
// Cost: below 1 us a sweep.
#pragma once

#include <cstddef>
#include <deque>

#include "core/moving_median.hpp"
#include "core/types/information_ahead.hpp"

namespace fail_aware {

class RoadAhead {
 public:
  /// Of the newest sweep. One that is not valid is one that sees nothing.
  void add(const InformationAhead& ahead);
  /// The median of five sweeps.
  InformationAhead ahead() const;
  /// Whether the sweeps see a fifth of what is weak here: posts and trees beside the road are not counted ahead.
  bool isWeak(double min_information_ratio) const;

 private:
  static constexpr std::size_t kSweeps = 5, kWeakSweeps = 9, kFewestKnown = 5;
  MovingMedian ratio_{kSweeps}, distance_m_{kSweeps};
  std::deque<InformationAhead> last_;
};

}  // namespace fail_aware
