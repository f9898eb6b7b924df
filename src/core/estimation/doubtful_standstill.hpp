// Whether the ICPs doubt a standstill that was found as the first motion. Not in the paper.
//
// Between vehicles of the same speed the clouds look as if the vehicle stood. Then neither ICP measures the
// position along the road, until the speed is observed (initial_guess/first_motion.hpp). The corners of those
// vehicles fit to centimetres, so without this rule they would confirm the standstill.
// Failure: none. Cost: negligible.
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
