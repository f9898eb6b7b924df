// The errors of each beam of the head, by ring: exchanged between their estimation
// (registration/beam_bias_estimator.hpp) and their correction (preprocessing/registration_cloud.hpp).
#pragma once

#include <vector>

namespace fail_aware {

/// Empty, or shorter than the ring's number: nothing is known of this beam.
struct BeamBias {
  std::vector<float> too_far_m;     ///< to be taken from each range
  std::vector<float> too_high_rad;  ///< to be taken from each elevation
};

}  // namespace fail_aware
