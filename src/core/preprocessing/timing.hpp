// The time at which each point of a sweep was measured, relative to the sweep's stamp (paper, section "LiDAR Sweep
// Correction").
//
// Sources: the driver's per-point field, or the azimuth of a head that rotates steadily. "auto" uses the field if it
// exists, holds times of this sweep and is not constant (the velodyne driver fills zeros for the 64E); otherwise the
// azimuth.
//
// Field: relative to the first packet (>= 0), to the last (<= 0), to the stamp (both signs), absolute on the stamp's
// clock, or on another clock. Of another clock only the differences count: the first point's time is the sweep's start,
// and `stamp_reference` gives the meaning of the stamp (auto: start). The first sweep decides which clock it is.
// Absolute times count from the true time of the sweep: the stamp without its jitter (sweep_clock.hpp).
// Units: point_times.hpp. A field that spans more than 2.5 periods is refused.
// Missing and isolated times are outliers: NaN in the result, and counted; leave these points out. Up to a tenth of a
// sweep's times may be outliers; with more the field is refused (not_finite, bad_scale).
// Backward: a head does not change its direction from one sweep to the next. Times that run against the earlier sweeps
// and against `clockwise` have the wrong sign, and are refused, for 100 sweeps at most.
// Held: a sweep whose field fails (refused, absent, or all equal) takes the timing of the sweeps before it
// (held_timing.hpp). If there is none, the sweep is timed by azimuth; `guessed()` distinguishes a refused
// field from a field that the driver leaves empty.
// Azimuth: from the start azimuth, in the direction of rotation: fraction = (1 - yaw/pi)/2 for clockwise from the rear.
// Known errors: a real head does not begin a sweep exactly at the start azimuth, so points within about one degree of
// the seam may belong to the other end and be wrong by a whole period; and each laser's own azimuth offset (a few
// degrees on an HDL-64E) counts as time.
//
// `stamp_reference`, the instant of the sweep that its stamp means, gives the result's interval: start [0, T], mid
// [-T/2, T/2], end [-T, 0]. "auto": from the sign of the field, else end. KITTI: mid.
// T: `sweep_period_s`, or the period from the sweep clock (sweep_clock.hpp), or, while that knows none, what the
// field's times show, or 0.1 s. The clock's period is wrong if every other sweep is lost from the start and points have
// no times: then set the period.
//
// Failure: with any status but kOk the times are empty. Cost: about 0.25 ms for 120 000 points.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/parameters/check.hpp"
#include "core/preprocessing/held_timing.hpp"
#include "core/types/timing_result.hpp"
#include "fail_aware_lidar_odometry/sweep.hpp"

namespace fail_aware {

/// For a sweep that is guessed(): what is refused, what is done instead, what to do. One line.
std::string describeGuess(const TimingResult& timing);

struct SweepTimingParams {
  std::string source = "auto";           ///< auto | field | azimuth | none
  std::string stamp_reference = "auto";  ///< start | mid | end | auto
  bool clockwise = true;                 ///< seen from above
  double start_azimuth_deg = 180.0;      ///< azimuth at which a sweep begins; 180: the rear
  double sweep_period_s = 0.0;           ///< 0: measured from the stamps
  double min_field_spread_s = 1e-3;      ///< a field with a smaller spread means no timing

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("source", self.source);
    v("stamp_reference", self.stamp_reference);
    v("clockwise", self.clockwise);
    v("start_azimuth_deg", self.start_azimuth_deg, within(-360.0, 360.0));
    v("sweep_period_s", self.sweep_period_s);
    v("min_field_spread_s", self.min_field_spread_s, requirePositive);
  }
  void checkRules() const;

  /// KITTI's stamps mean the instant of facing forward, unless the parameters say otherwise.
  void useKittiStamps() {
    if (stamp_reference == "auto") stamp_reference = "mid";
  }
};

/// Times from the azimuth (see above) for any `source`: s from the instant at `zero_position` (0: start, 1: end) of a
/// sweep of period_s. One per point, in [-zero_position, 1 - zero_position] * period_s.
void timesByAzimuth(const SweepTimingParams& params, const std::vector<Eigen::Vector3f>& points_lidar,
                    double zero_position, double period_s, std::vector<float>& times_s);

struct TimeRange;  // point_times.hpp

class SweepTiming {
 public:
  using Params = SweepTimingParams;

  explicit SweepTiming(const Params& params) : params_(params) {}

  /// Seconds from the stamp's instant to each point's, in the sweep's order; NaN for outliers. `measured_period_s`: of
  /// the head, from the sweep clock; 0: not known. `stamp_error_s`: likewise, of the stamp (SweepTime::error_s).
  TimingResult assign(const Sweep& sweep, double measured_period_s, std::vector<float>& times_relative_to_stamp_s,
                      double stamp_error_s = 0.0);

  /// Forgets the field's clock and the timing of earlier sweeps.
  void reset();

 private:
  TimeField assignField(const Sweep& sweep, double stamp_error_s, TimingResult& result, std::vector<float>& times_s);
  double fieldOffset_s(const Sweep& sweep, const TimeRange& range, double limit_s, double stamp_error_s,
                       TimingResult& result);
  double jitterOf(double first_s, double stamp_error_s);
  StampReference referenceOr(StampReference automatic) const;

  enum class Clock { kSweep, kStamp, kOther };
  Clock clockOf(double first_s, double last_s, double stamp_s, double limit_s) const;

  Params params_;
  std::optional<Clock> clock_;  ///< of the field
  /// Of the last sweep that its field timed: timing, reference, and the first point's time relative to the stamp.
  HeldTiming held_;
  StampReference last_reference_ = StampReference::kEnd;
  double last_first_s_ = 0.0;
  double shared_error_s_ = 0.0;  ///< the part of the stamp's error that is the points' error, too
  int backward_sweeps_ = 0;      ///< in a row, so far
};

}  // namespace fail_aware
