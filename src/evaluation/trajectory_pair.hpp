// What every trajectory metric starts from: a true and an estimated trajectory, pose by pose, in the same moving frame.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/geometry/pose.hpp"

namespace fail_aware {

/// Throws InputError, naming both counts, unless there are equally many and at least two poses.
void requirePosePairs(const std::vector<Pose>& truth, const std::vector<Pose>& estimate);

/// E = (estimated motion)^-1 (true motion), the motions being those from pose `first` to pose `last`.
Pose relativeError(const std::vector<Pose>& truth, const std::vector<Pose>& estimate, std::size_t first,
                   std::size_t last);

/// For the user, if one of the two reaches more than 10 times as far from its first pose as the other, and more than
/// 10 m; otherwise empty.
std::string extentFault(const std::vector<Pose>& truth, const std::vector<Pose>& estimate);

}  // namespace fail_aware
