// The error of an implausible motion (estimation/consistency_monitor.hpp). The map gets it, too, so that no later
// registration takes it back.
#pragma once

namespace fail_aware {

/// Standard deviations; 0: the motion is plausible.
struct MotionDoubt {
  double sigma_m = 0.0;  ///< along the road and across it
  double sigma_yaw_rad = 0.0;
};

}  // namespace fail_aware
