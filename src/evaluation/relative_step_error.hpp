// The error of single steps: root mean square over all consecutive poses of E = (estimated motion)^-1 (true motion).
//
// Units m and rad. Poses in pairs (else InputError). On real ground truth its own noise is part of the figure.
#pragma once

#include <vector>

#include "core/geometry/pose.hpp"

namespace fail_aware {

struct RelativeStepError {
  double translation_rmse_m = 0.0;
  double rotation_rmse_rad = 0.0;
};

RelativeStepError relativeStepError(const std::vector<Pose>& truth, const std::vector<Pose>& estimate);

}  // namespace fail_aware
