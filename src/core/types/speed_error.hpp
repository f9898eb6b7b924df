// The error of a speed that the measurements do not observe (estimation/dead_reckoning.hpp).
#pragma once

namespace fail_aware {

/// Error of the speed along the vehicle's axis. Zero where the measurements observe the speed.
struct SpeedError {
  double variance_m2_s2 = 0.0;  ///< after this sweep
  double kept = 0.0;            ///< ratio of the last sweep's error that remains in it, 0..1
};

}  // namespace fail_aware
