// Weighted rigid alignment of paired points (Kabsch: SVD of the cross-covariance, reflection guarded).
// Paper, section "SVD Cornering Algorithm", Equation (SVDDescription).
//
// Failure: too few or badly placed points leave `ok()` false and T the identity; `rank` says why.
// Cost: one pass over the pairs and one 3x3 SVD.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/pose.hpp"

namespace fail_aware {

struct RigidAlignment {
  Pose T_target_source = Pose::Identity();  ///< minimises sum w |target - T source|^2
  int rank = 0;         ///< of the pairs' spread: 0: no pair or all at one point, 1: collinear, 2: planar, 3
  bool unique = false;  ///< the rotation is determined (rank >= 2, and no mirror image with several solutions)
  double rms_m = 0.0;   ///< remaining weighted RMS distance
  bool ok() const { return unique; }
};

/// `source`, `target`: equal numbers of points, m. `weights`: empty (all 1) or one per pair, >= 0. Pairs that are not
/// finite or have no weight are left out.
RigidAlignment alignRigid(const std::vector<Eigen::Vector3d>& source, const std::vector<Eigen::Vector3d>& target,
                          const std::vector<double>& weights = {});

}  // namespace fail_aware
