#include "evaluation/trajectory_pair.hpp"

#include <string>

#include "core/io/input_error.hpp"

namespace fail_aware {

void requirePosePairs(const std::vector<Pose>& truth, const std::vector<Pose>& estimate) {
  if (truth.size() != estimate.size()) {
    throw InputError("ground truth has " + std::to_string(truth.size()) + " poses, estimate has " +
                     std::to_string(estimate.size()) + ": they must be equally many");
  }
  if (truth.size() < 2) {
    throw InputError("at least 2 poses are needed, there " + std::string(truth.size() == 1 ? "is 1" : "are 0"));
  }
}

Pose relativeError(const std::vector<Pose>& truth, const std::vector<Pose>& estimate, std::size_t first,
                   std::size_t last) {
  const Pose true_motion = truth[first].inverse() * truth[last];
  const Pose estimated_motion = estimate[first].inverse() * estimate[last];
  return estimated_motion.inverse() * true_motion;
}

}  // namespace fail_aware
