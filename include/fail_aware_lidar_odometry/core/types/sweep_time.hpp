// The time of a sweep: its stamp and the stamp's error, as the sweep clock (sweep/sweep_clock.hpp) finds it. Units: s.
#pragma once

namespace fail_aware {

struct SweepTime {
  SweepTime() = default;
  SweepTime(double right_stamp_s)
      : stamp_s(right_stamp_s) {}  // NOLINT(google-explicit-constructor): a stamp that is right

  double stamp_s = 0.0;           ///< as it came
  double error_s = 0.0;           ///< of the stamp: stamp minus the sweep's time
  double interval_sigma_s = 0.0;  ///< standard deviation of the time since the last sweep; 0: negligible
  double period_s = 0.0;          ///< of the head; 0: not known yet
  double set_back_s = 0.0;  ///< a stamp was refused since the last sweep that was so much older, and not for a clock
                            ///< that was set back; 0: none was

  double time_s() const { return stamp_s - error_s; }
};

}  // namespace fail_aware
