// Weighted rigid alignment of paired points (Kabsch: SVD of the cross-covariance, reflection guarded).
// Paper, section "SVD Cornering Algorithm", Equation (SVDDescription).
//
// Failure: no pose if the points leave the rotation open: too few, in one place or on a line, or mirrored with several
// solutions. Cost: one pass over the pairs and one 3x3 SVD.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geometry/pose.hpp"

namespace fail_aware {

/// T_target_source that minimises sum w |target - T source|^2. Equal numbers of points (m) and weights (> 0), finite.
std::optional<Pose> alignRigid(const std::vector<Eigen::Vector3d>& source, const std::vector<Eigen::Vector3d>& target,
                               const std::vector<double>& weights);

}  // namespace fail_aware
