// The time of a sweep: its stamp and the stamp's error from the sweep clock (estimation/sweep_clock.hpp).
// Units: s.
#pragma once

namespace fail_aware {

struct SweepTime {
  SweepTime() = default;
  SweepTime(double right_stamp_s)
      : stamp_s(right_stamp_s) {}  // NOLINT(google-explicit-constructor): a stamp without error

  double stamp_s = 0.0;           ///< as received
  double error_s = 0.0;           ///< of the stamp: stamp minus the sweep's time
  double interval_sigma_s = 0.0;  ///< standard deviation of the time since the last sweep; 0: negligible
  double period_s = 0.0;          ///< of the head; 0: not known yet
  /// A stamp was refused since the last sweep because it was this much older, but not as a clock that was set back.
  /// 0: none.
  double set_back_s = 0.0;

  double time_s() const { return stamp_s - error_s; }
};

}  // namespace fail_aware
