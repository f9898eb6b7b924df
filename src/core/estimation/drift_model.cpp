#include "core/estimation/drift_model.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/degree.hpp"

namespace fail_aware {

namespace {

constexpr double kNewMapDistance_m = 0.1;
constexpr double kMapViews = 1.5;               // a map is this many ranges of view long, at most
constexpr double kNewMapTilt_rad_per_m = 0.09;  // 0.1 deg where the position is off by 2 cm

double squared(double value) { return value * value; }

}  // namespace

Vector6d DriftModel::newMapVariances(double from_m, double to_m) const {
  const auto share = [](double distance_m) { return std::min(1.0, distance_m / kNewMapDistance_m); };
  const double variance_m2 = squared(new_map_m) * std::max(0.0, share(to_m) - share(from_m));
  Vector6d variances = Vector6d::Zero();
  variances.head<3>().setConstant(variance_m2);
  variances.segment<2>(3).setConstant(squared(kNewMapTilt_rad_per_m) * variance_m2);
  return variances;
}

Vector6d DriftModel::walkVariances(double distance_m) const {
  const double tilt = squared(tilt_per_root_metre_deg * kDegree) * distance_m;
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(squared(position_per_root_metre_m) * distance_m), tilt, tilt,
      squared(heading_per_root_metre_deg * kDegree) * distance_m;
  return variances;
}

double DriftModel::mapReplaced(double distance_m, double view_range_m) const {
  const double length_m = view_range_m > 0.0 ? std::min(map_length_m, kMapViews * view_range_m) : map_length_m;
  return length_m > 0.0 ? std::min(1.0, distance_m / length_m) : 1.0;
}

Matrix6d DriftModel::transient(const Matrix6d& registration) const {
  Vector6d root;
  root << Eigen::Vector3d::Constant(std::sqrt(transient_ratio)),
      Eigen::Vector3d::Constant(std::sqrt(transient_rotation_ratio));
  return root.asDiagonal() * registration * root.asDiagonal();
}

Eigen::Vector2d DriftModel::biasVariances() const {
  return {squared(heading_bias_deg_per_m * kDegree), squared(scale_bias)};
}

}  // namespace fail_aware
