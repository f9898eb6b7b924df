// Which directions of a registration count. Where a registration observes nothing, it stays at its guess, and its
// covariance says so with a standard deviation of some decimetres to metres. Taken for a measurement ten times a second,
// that would hold a covariance at a few decimetres, however far the pose goes off.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/types/fusion_input.hpp"
#include "core/types/fusion_result.hpp"

namespace fail_aware {

/// Standard deviations (m or rad): a direction with a smaller one than `surely` counts as it is, with a larger one than
/// `hardly` not at all, between them less and less.
struct ObservedLimit {
  double surely, hardly;
};

/// Opens the directions of a covariance of position or rotation that do not count.
void openUnobserved(const ObservedLimit& limit, Eigen::Ref<Eigen::Matrix3d> block);

/// The fused R as the filter uses it: directions of the position with more than 1 to 2 m are open, unless a pose from
/// elsewhere is part of it, which measures in all directions.
Matrix6d covarianceForFilter(const FusionResult& fusion, const std::vector<FusionInput>& inputs);

}  // namespace fail_aware
