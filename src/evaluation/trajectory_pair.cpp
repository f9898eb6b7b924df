#include "evaluation/trajectory_pair.hpp"

#include <algorithm>
#include <cmath>
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

std::string extentFault(const std::vector<Pose>& truth, const std::vector<Pose>& estimate) {
  const auto extent = [](const std::vector<Pose>& poses) {
    double extent_m = 0.0;
    for (const Pose& pose : poses) {
      extent_m = std::max(extent_m, (pose.translation() - poses.front().translation()).norm());
    }
    return extent_m;
  };
  constexpr double kRatio = 10.0, kLeast_m = 10.0;
  const double truth_m = extent(truth), estimate_m = extent(estimate);
  const auto [shorter_m, longer_m] = std::minmax(truth_m, estimate_m);
  if (longer_m <= kLeast_m || longer_m <= kRatio * shorter_m) return {};
  return "the true poses reach " + std::to_string(std::lround(truth_m)) + " m from the first one, the estimated " +
         std::to_string(std::lround(estimate_m)) + " m: if the odometry was not lost, the ground truth is another " +
         "drive's or not in m";
}

}  // namespace fail_aware
