// What became of a pose that was set from outside, in one sweep. Not in the paper.
#pragma once

#include <string>

namespace fail_aware {

struct PoseSet {
  bool done = false;    ///< odom was moved under the vehicle
  std::string refused;  ///< why it was not; empty: none waited, or it is done
};

}  // namespace fail_aware
