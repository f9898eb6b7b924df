// Which measurements of one sweep agree with each other, and how much their disagreement counts
// (measurement_fusion.hpp explains the rules). Internal to the fusion.
//
// States: x y z roll pitch yaw of the centre of gravity in odom; m, rad. Failure: none. Cost: O(n^2) 2x2 matrices.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/types/fusion_result.hpp"

namespace fail_aware {

/// A usable measurement as a state with its covariance.
struct FusionCandidate {
  std::size_t input;  ///< its index among the fusion's inputs
  bool external;
  Vector6d z;
  Matrix6d R;
  Matrix6d information;
};

/// The Mahalanobis distance of a horizontal offset; a covariance without width counts as a very small one.
double mahalanobis2d(const Eigen::Vector2d& d, const Eigen::Matrix2d& C);

/// The largest group whose members all agree with each other; the tighter of equals. Indices of `candidates`.
std::vector<std::size_t> largestAgreement(const std::vector<FusionCandidate>& candidates, double distance_m,
                                          double yaw_rad);

/// Sets the result's disagreements and `confirmed`, from the candidates and the result's weights.
void judgeDisagreement(const std::vector<FusionCandidate>& candidates, double agreement_distance_m,
                       FusionResult* result);

}  // namespace fail_aware
