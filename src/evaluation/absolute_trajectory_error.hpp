// Absolute trajectory error: the estimated trajectory is laid on the true one as a whole, then compared pose by pose.
//
// Two ways to lay it: the first poses coincide (what a vehicle that starts there would see), or the rigid motion
// without scale that minimises the squared position error (Umeyama, TPAMI 1991). Yaw is the direction of the estimated
// x axis seen in the true moving frame (z up). Poses in pairs (else InputError). Units m and rad. Cost: linear.
// Positions on one straight line leave the rotation about it open: position errors and yaw do not depend on it.
#pragma once

#include <vector>

#include "core/geometry/pose.hpp"

namespace fail_aware {

struct AbsoluteTrajectoryError {
  double rmse_m = 0.0;
  double mean_m = 0.0;
  double max_m = 0.0;
  double yaw_rmse_rad = 0.0;
  std::vector<double> position_error_m;  ///< one a pose
};

/// T with T * estimate[0] = truth[0].
Pose firstPoseAlignment(const std::vector<Pose>& truth, const std::vector<Pose>& estimate);

/// T, rigid and without scale, that minimises sum |truth_i - T estimate_i|^2 over positions.
Pose bestAlignment(const std::vector<Pose>& truth, const std::vector<Pose>& estimate);

AbsoluteTrajectoryError absoluteTrajectoryError(const std::vector<Pose>& truth, const std::vector<Pose>& estimate,
                                                const Pose& T_truth_estimate);

}  // namespace fail_aware
