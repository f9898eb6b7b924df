// Times for a sweep whose time field fails: by azimuth, with the direction, the start and the stamp reference that the
// field of earlier sweeps showed. Not in the paper.
//
// Works for a rotating head: the azimuth must follow the field's times. A cloud may hold a revolution or an integer
// fraction of one (a half, a third, a quarter). Points within about one degree of the seam may get the time of the
// other end.
// Failure: apply() returns false. Cost: keep() 0.05 ms, apply() as timesByAzimuth().
#pragma once

#include <optional>
#include <vector>

#include "fail_aware_lidar_odometry/sweep.hpp"

namespace fail_aware {

class HeldTiming {
 public:
  struct Head {
    double stamp_s = 0.0;  ///< of the sweep that shows it
    double first_s = 0.0;  ///< first time of its points, relative to the stamp
    double period_s = 0.1;
    double revolution_s = 0.1;
    double start_azimuth_rad = 0.0;
    bool clockwise = true;
  };

  /// The head that a sweep with a valid field shows. times_s: relative to its stamp, may hold NaN; first_s: the first
  /// time. None: the azimuth does not follow the times.
  static std::optional<Head> headOf(const Sweep& sweep, const std::vector<float>& times_s, double first_s,
                                    double period_s);

  void keep(const std::optional<Head>& head) { head_ = head; }

  /// The head that is kept turns in the other direction.
  bool turnsAgainst(const Head& head) const { return head_ && head_->clockwise != head.clockwise; }

  /// False: no sweep was kept, or its azimuth did not follow its times. Times: relative to the stamp.
  bool apply(const Sweep& sweep, std::vector<float>& times_s) const;

  void reset() { head_.reset(); }

 private:
  std::optional<Head> head_;
};

}  // namespace fail_aware
