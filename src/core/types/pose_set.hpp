// The result of a pose that was set from outside, in one sweep. Not in the paper.
#pragma once

#include <string>

namespace fail_aware {

struct PoseSet {
  bool done = false;    ///< odom was reset to the new pose
  std::string refused;  ///< the reason for a refusal; empty: it is done, it waits for a motion, or there was none
};

}  // namespace fail_aware
