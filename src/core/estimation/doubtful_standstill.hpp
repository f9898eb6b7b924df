// Whether the ICPs doubt a standstill that was found as the first motion. Not in the paper.
//
// Amid vehicles that travel along on a highway nothing seems to move. While the speed was never observed, both ICPs say
// so (initial_guess/first_motion.hpp): they leave the way along the road open. The corners of those vehicles do not:
// they fit to centimetres, and must not be what ends the doubt.
// Failure: none. Cost: none to speak of.
#pragma once

#include <algorithm>
#include <vector>

#include "core/types/fusion_input.hpp"

namespace fail_aware {

/// Leaves the corners out while the ICPs doubt the standstill.
inline void leaveOutCornersOfConvoys(std::vector<FusionInput>& inputs) {
  const auto isAnIcp = [](const FusionInput& input) { return input.isOfAnIcp() && input.usable(); };
  const auto isOpen = [&](const FusionInput& input) {
    return !isAnIcp(input) ||
           (input.measurement->min_information_ratio == 0.0 && input.measurement->degenerate_directions > 0);
  };
  if (std::none_of(inputs.begin(), inputs.end(), isAnIcp) || !std::all_of(inputs.begin(), inputs.end(), isOpen)) return;
  for (FusionInput& input : inputs) {
    if (input.name == kCornerSvd) input.measurement = nullptr;
  }
}

}  // namespace fail_aware
