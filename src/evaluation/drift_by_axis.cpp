#include "evaluation/drift_by_axis.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"
#include "evaluation/trajectory_pair.hpp"

namespace fail_aware {

namespace {

/// along, across, up (m), roll, pitch, yaw (rad); absolute.
Vector6d errorByAxis(const Pose& T_truth, const Pose& T_estimate) {
  const Eigen::Vector3d error = T_estimate.translation() - T_truth.translation();
  const Eigen::Vector3d along = T_truth.translation().normalized();
  const Eigen::Vector3d across = Eigen::Vector3d::UnitZ().cross(along).normalized();
  Vector6d by_axis;
  by_axis << error.dot(along), error.dot(across), error.z(),
      rpyFromRotation(T_truth.linear().transpose() * T_estimate.linear());
  return by_axis.cwiseAbs();
}

}  // namespace

std::vector<DriftByAxis> driftByAxis(const std::vector<Pose>& truth, const std::vector<Pose>& estimate,
                                     const KittiMetric::Params& params) {
  params.validate();
  requirePosePairs(truth, estimate);
  const std::vector<double> distances_m = distancesAlong(truth);
  std::vector<DriftByAxis> result;
  for (const double length_m : params.lengths_m) {
    Vector6d sum = Vector6d::Zero();
    const auto segments = segmentsOf(distances_m, length_m, params.step);
    for (const auto& [first, last] : segments) {
      sum += errorByAxis(truth[first].inverse() * truth[last], estimate[first].inverse() * estimate[last]);
    }
    const Vector6d mean = sum / (length_m * static_cast<double>(std::max<std::size_t>(segments.size(), 1)));
    result.push_back({length_m, segments.size(), 100.0 * mean[0], 100.0 * mean[1], 100.0 * mean[2], mean[3] / kDegree,
                      mean[4] / kDegree, mean[5] / kDegree});
  }
  return result;
}

}  // namespace fail_aware
