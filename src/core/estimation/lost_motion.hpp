// Tells when the local map has become useless while the speed was dead-reckoned. Not in the paper.
//
// Where measurements do not observe the speed (a tunnel, thick fog), the sweeps are inserted at dead-reckoned poses.
// When the speed can be observed again and is far from the dead-reckoned one, the sweeps do not fit the map:
// registration converges to nearby minima, which differ with the last digits, and the speed taken from them diverges.
// The inlier ratio shows it: it stays far below the usual one. Then the motion is unknown, as at the start of a drive:
// the map begins anew and the motion is searched for. The error of the pose stays as large as it was.
// After a gap (no measurement) relocalization.hpp searches in the map instead.
// Failure: none. Cost: under 1 us a sweep.
#pragma once

#include <cstddef>
#include <optional>

#include "core/moving_median.hpp"

namespace fail_aware {

class LostMotion {
 public:
  /// `believed_ratio`: below this inlier ratio the few inliers only repeat the prediction, and say nothing about the
  /// map (ConsistencyMonitor::Params::fitting_ratio). 0: the motion is never lost.
  explicit LostMotion(double believed_ratio) : believed_ratio_(believed_ratio) {}

  /// `dead_reckoned`: the speed before this sweep was not observed. `inlier_ratio`: of point-to-plane; none:
  /// it did not measure. Returns whether the motion is lost: the sweeps are believed, but do not fit.
  bool add(bool dead_reckoned, const std::optional<double>& inlier_ratio);

  void clear() { *this = LostMotion(believed_ratio_); }

 private:
  /// sweeps; five or six of them must fit badly. When a covered sector or fog clears, the map is empty where the lidar
  /// sees again, and some five sweeps fit badly, too.
  static constexpr std::size_t kRecent = 10;

  double believed_ratio_;
  MovingMedian usual_ratio_{20};  ///< while the speed was observed
  MovingMedian recent_ratio_{kRecent};
  int dead_reckoned_sweeps_ = 0;  ///< consecutive, measured
  bool usual_is_assumed_ = true;  ///< until it is known; not after a loss: then the surroundings may fit badly
  int watched_sweeps_ = 0;        ///< left, in which the map may prove useless
};

}  // namespace fail_aware
