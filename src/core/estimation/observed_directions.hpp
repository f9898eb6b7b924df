// Which directions of a registration count. Where a registration observes nothing, it stays at its guess, and its
// covariance says so with a standard deviation of some decimetres to metres. Taken for a measurement ten times a second,
// that would hold a covariance at a few decimetres, however far the pose goes off.
#pragma once

#include <Eigen/Core>

namespace fail_aware {

/// Standard deviations (m or rad): a direction with a smaller one than `surely` counts as it is, with a larger one than
/// `hardly` not at all, between them less and less.
struct ObservedLimit {
  double surely, hardly;
};

/// Opens the directions of a covariance of position or rotation that do not count.
void openUnobserved(const ObservedLimit& limit, Eigen::Ref<Eigen::Matrix3d> block);

}  // namespace fail_aware
