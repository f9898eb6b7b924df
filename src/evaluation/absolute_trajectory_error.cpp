#include "evaluation/absolute_trajectory_error.hpp"

#include <algorithm>
#include <cmath>

#include "evaluation/trajectory_pair.hpp"

namespace fail_aware {

namespace {

Eigen::Matrix3Xd positions(const std::vector<Pose>& poses) {
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(poses.size()));
  for (std::size_t i = 0; i < poses.size(); ++i) points.col(static_cast<Eigen::Index>(i)) = poses[i].translation();
  return points;
}

}  // namespace

Pose firstPoseAlignment(const std::vector<Pose>& truth, const std::vector<Pose>& estimate) {
  requirePosePairs(truth, estimate);
  return truth.front() * estimate.front().inverse();
}

Pose bestAlignment(const std::vector<Pose>& truth, const std::vector<Pose>& estimate) {
  requirePosePairs(truth, estimate);
  const bool with_scaling = false;
  Pose T_truth_estimate = Pose::Identity();
  T_truth_estimate.matrix() = Eigen::umeyama(positions(estimate), positions(truth), with_scaling);
  return orthonormalized(T_truth_estimate);
}

AbsoluteTrajectoryError absoluteTrajectoryError(const std::vector<Pose>& truth, const std::vector<Pose>& estimate,
                                                const Pose& T_truth_estimate) {
  requirePosePairs(truth, estimate);
  AbsoluteTrajectoryError error;
  error.position_error_m.reserve(truth.size());
  double squares = 0.0, sum = 0.0, yaw_squares = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Pose E = truth[i].inverse() * T_truth_estimate * estimate[i];
    const double distance_m = E.translation().norm();
    const double yaw_rad = std::atan2(E(1, 0), E(0, 0));
    error.position_error_m.push_back(distance_m);
    error.max_m = std::max(error.max_m, distance_m);
    sum += distance_m;
    squares += distance_m * distance_m;
    yaw_squares += yaw_rad * yaw_rad;
  }
  const double count = static_cast<double>(truth.size());
  error.rmse_m = std::sqrt(squares / count);
  error.mean_m = sum / count;
  error.yaw_rmse_rad = std::sqrt(yaw_squares / count);
  return error;
}

}  // namespace fail_aware
