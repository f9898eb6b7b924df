#include "evaluation/relative_step_error.hpp"

#include <cmath>

#include "core/geometry/rotation.hpp"
#include "evaluation/trajectory_pair.hpp"

namespace fail_aware {

RelativeStepError relativeStepError(const std::vector<Pose>& truth, const std::vector<Pose>& estimate) {
  requirePosePairs(truth, estimate);
  double translation_sum = 0.0, rotation_sum = 0.0;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const Pose E = relativeError(truth, estimate, i - 1, i);
    translation_sum += E.translation().squaredNorm();
    rotation_sum += logSo3(E.linear()).squaredNorm();
  }
  const double steps = static_cast<double>(truth.size() - 1);
  return {std::sqrt(translation_sum / steps), std::sqrt(rotation_sum / steps)};
}

}  // namespace fail_aware
