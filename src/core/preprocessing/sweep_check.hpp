// Checks of a raw sweep. Not in the paper. The monitor's reasons SWEEP_INCOMPLETE, FROZEN_CLOUD, LOW_VISIBILITY and
// TIME_JUMP come from here, offline and live.
//
// incomplete      fewer than min_azimuth_coverage of the azimuth's sectors (5 deg each) hold points: half a sweep, or a
//                 blanked sector. A driver that publishes part of a revolution per cloud needs a lower
//                 min_azimuth_coverage.
// low_visibility  fewer than 2 % of the points lie beyond min_view_range_m: fog, spray, a dirty window
// frozen          the points are, bit for bit, those of each of the last frozen_sweeps sweeps: a driver that repeats
//                 itself (a simulator without noise does the same while the vehicle stands: 0 switches this off)
// repeats         the points are those of the last sweep: nothing new to register, the sweep counts as empty
// partial_start   the first sweep, and it is incomplete: a driver that begins in mid-revolution. Counts as empty:
//                 a drive that begins with it may find a wrong first motion
// time_jump       the stamp is more than max_gap_s after the last one, or before it
// An empty sweep has none of the first three.
// Input: raw points in the lidar's frame, m.
// Cost: 0.5 ms for 120 000 points (coverage and range use every n-th point, about 20 000 in all).
#pragma once

#include <cstddef>
#include <optional>

#include "core/parameters/check.hpp"
#include "core/types/sweep_findings.hpp"
#include "fail_aware_lidar_odometry/sweep.hpp"

namespace fail_aware {

struct SweepCheckParams {
  double min_azimuth_coverage = 0.75;  ///< ratio of the sectors; 0: off, for a lidar without full azimuth
  double min_view_range_m = 15.0;      ///< 0: off
  int frozen_sweeps = 3;               ///< repetitions in a row; 0: off
  double max_gap_s = 0.5;              ///< between stamps

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("min_azimuth_coverage", self.min_azimuth_coverage, within(0.0, 1.0));
    v("min_view_range_m", self.min_view_range_m, requireNotNegative);
    v("frozen_sweeps", self.frozen_sweeps, within(0, 1000));
    v("max_gap_s", self.max_gap_s, requirePositive);
  }
};

/// Explains an incomplete sweep, and what to set if the driver publishes such clouds. One line.
const char* describeIncomplete();

/// Keeps stamp and fingerprint of the last sweep: pass every sweep, in order, including the first one after the stamps
/// jumped back.
class SweepCheck {
 public:
  explicit SweepCheck(const SweepCheckParams& params) : params_(params) {}

  SweepFindings check(const Sweep& sweep);
  void reset() { *this = SweepCheck(params_); }
  /// Forgets all but the last stamp: a first sweep that comes long after it, or before it, still gives time_jump.
  void beginDrive() {
    const std::optional<double> stamp_s = last_stamp_s_;
    reset();
    last_stamp_s_ = stamp_s;
  }

 private:
  SweepCheckParams params_;
  std::optional<double> last_stamp_s_;
  std::optional<std::size_t> last_fingerprint_;
  int repetitions_ = 0;
  bool any_ = false;  ///< a sweep with points came
};

}  // namespace fail_aware
