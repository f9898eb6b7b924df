// The pairs of a sweep's points and the map's plane patches for the point-to-plane registrations
// (icp_point_to_plane.hpp; paper, section "Normal Filtering ICP"): which pairs count, and with which weight.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"
#include "core/registration/icp_point_to_plane.hpp"
#include "core/robust_kernel.hpp"

namespace fail_aware {

// Selects the plane patches that may be paired, given the predicted heading.
class NormalFilter {
 public:
  NormalFilter(const IcpPointToPlane::Params& params, double heading_rad, double sigma_yaw_rad)
      : enabled_(params.filter_normals),
        keep_ground_(params.keep_ground),
        min_ground_z_(static_cast<float>(std::cos(params.ground_tolerance_deg * kDegree))),
        max_wall_z_(static_cast<float>(std::sin(params.vertical_tolerance_deg * kDegree))),
        cos4_heading_(static_cast<float>(std::cos(4.0 * heading_rad))),
        sin4_heading_(static_cast<float>(std::sin(4.0 * heading_rad))) {
    const double tolerance = std::min(std::max(sigma_yaw_rad, params.heading_tolerance_deg * kDegree), M_PI / 4.0);
    min_cos4_ = static_cast<float>(std::cos(4.0 * tolerance)) - 1e-6f;
  }

  bool isGround(const Eigen::Vector3f& n) const { return std::abs(n.z()) >= min_ground_z_; }

  bool keeps(const Eigen::Vector3f& n) const {
    if (!enabled_) return true;
    if (isGround(n)) return keep_ground_;
    if (std::abs(n.z()) > max_wall_z_) return false;
    // the angle to heading + k pi/2 is within the tolerance: cos(4 (azimuth - heading)) >= cos(4 tolerance)
    const float h2 = n.x() * n.x() + n.y() * n.y();
    const float c2 = (n.x() * n.x() - n.y() * n.y()) / h2, s2 = 2.0f * n.x() * n.y() / h2;
    const float c4 = c2 * c2 - s2 * s2, s4 = 2.0f * c2 * s2;
    return c4 * cos4_heading_ + s4 * sin4_heading_ >= min_cos4_;
  }

 private:
  bool enabled_, keep_ground_;
  float min_ground_z_, max_wall_z_, cos4_heading_, sin4_heading_, min_cos4_;
};

/// Residual n . (R q + t - mean), m.
struct PlanePair {
  Eigen::Vector3d position;  ///< of the point, in odom
  Eigen::Vector3d normal;
  double normal_variance = 0.0;  ///< rad^2
  Vector6d J;                    ///< of the residual, dx as in normal_equations.hpp
  double residual_m = 0.0;
  double kernel_weight = 0.0, kernel_curvature = 0.0;
  double weight = 0.0;  ///< kernel weight over the variance
  /// The weight in ratios of information: that of ground is multiplied by `ground_information_weight`.
  double information_weight = 0.0;

  void addTo(NormalEquations& equations) const {
    equations.H.selfadjointView<Eigen::Lower>().rankUpdate(J, weight);
    equations.b -= weight * residual_m * J;
    equations.weight += information_weight;
    equations.weight_unscaled += kernel_weight;
    equations.curvature += information_weight * kernel_curvature;
    equations.squared_error += kernel_weight * residual_m * residual_m;
    ++equations.inliers;
  }
};

/// positionOf for points that keep their deskew.
inline constexpr auto kAsCorrected = [](const Eigen::Vector3d& arm, std::size_t) { return arm; };

/// For one cloud and one map, which must not change while this object is used.
class PlanePairs {
 public:
  PlanePairs(const IcpPointToPlane::Params& params, const std::vector<Eigen::Vector3f>& points_cog, const VoxelMap& map,
             const Pose& T_odom_cog_predicted, double sigma_yaw_rad, std::size_t stride = 1)
      : params_(params),
        points_cog_(points_cog),
        map_(map),
        stride_(stride),
        filter_(params, rpyFromRotation(T_odom_cog_predicted.linear()).z(), sigma_yaw_rad),
        neighborhoods_((points_cog.size() + stride - 1) / stride) {}

  /// Calls take(pair, i) for each of every stride-th points i that has a pair. positionOf(R q, i): the point's position
  /// relative to the vehicle's position, in odom's axes.
  template <class PositionOf, class Take>
  void forEach(const Pose& T_odom_cog, double kernel_m, const PositionOf& positionOf, const Take& take) {
    const double point_variance = params_.point_sigma_m * params_.point_sigma_m;
    const auto max_distance_m = static_cast<float>(params_.max_distance_m);
    const double kernel2 = kernel_m * kernel_m;
    const Eigen::Matrix3d R = T_odom_cog.linear();
    const Eigen::Vector3d t = T_odom_cog.translation();
    VoxelMap::PlaneMatch match;
    PlanePair pair;
    for (std::size_t k = 0; k < neighborhoods_.size(); ++k) {
      if (k + VoxelMap::kPrefetchAhead < neighborhoods_.size())
        map_.prefetchPlane(neighborhoods_[k + VoxelMap::kPrefetchAhead]);
      const std::size_t i = k * stride_;
      const Eigen::Vector3f& q = points_cog_[i];
      const Eigen::Vector3d arm = positionOf(Eigen::Vector3d(R * q.cast<double>()), i);
      pair.position = arm + t;
      if (!map_.findPlane(pair.position, match, neighborhoods_[k])) continue;
      const PlanePatch& plane = *match.plane;
      if (!(std::abs(match.distance_m) <= max_distance_m) || !filter_.keeps(plane.normal)) continue;
      const double r = match.distance_m;
      pair.normal = plane.normal.cast<double>();
      pair.normal_variance = plane.normal_variance;
      pair.J << pair.normal, arm.cross(pair.normal);
      pair.residual_m = r;
      pair.kernel_weight = gemanMcClureWeight(r * r, kernel2);
      pair.kernel_curvature = gemanMcClureCurvature(r * r, r * r, kernel2);
      pair.weight = pair.kernel_weight / (point_variance + plane.variance + tiltVariance(match));
      if (params_.range_weight_m > 0.0) pair.weight *= static_cast<double>(q.norm()) / params_.range_weight_m;
      pair.information_weight = pair.weight;
      if (filter_.isGround(plane.normal)) {
        pair.weight *= params_.ground_weight;
        pair.information_weight *= params_.ground_information_weight;
      }
      take(pair, i);
    }
  }

  /// Of points that keep their deskew.
  NormalEquations linearize(const Pose& T_odom_cog, double kernel_m) {
    NormalEquations equations;
    forEach(T_odom_cog, kernel_m, kAsCorrected, [&](const PlanePair& pair, std::size_t) { pair.addTo(equations); });
    equations.H = equations.H.selfadjointView<Eigen::Lower>();
    return equations;
  }

 private:
  /// What a tilt of the patch about its longest extent may do to the residual, m^2. The points of one scan line have
  /// errors in common (scan_line_sigma_m), so the tilt is known to scan_line_sigma_m / sqrt(spread), rad; of a single
  /// line it is not known at all. Among the points it does no harm: spread evenly, they reach as far as sqrt(3 spread).
  /// A point's distance from the plane counts by the square of the tilt; the kernel's curvature leaves that out.
  double tiltVariance(const VoxelMap::PlaneMatch& match) const {
    const double spread = match.plane->spread, tangential_m = match.tangential_m, distance_m = match.distance_m;
    const double beyond = std::max(0.0, tangential_m * tangential_m - 3.0 * spread);
    const double tilt = std::min(1.0, params_.scan_line_sigma_m * params_.scan_line_sigma_m / spread);
    return tilt * beyond + tilt * tilt * distance_m * distance_m;
  }

  const IcpPointToPlane::Params& params_;
  const std::vector<Eigen::Vector3f>& points_cog_;
  const VoxelMap& map_;
  std::size_t stride_;
  NormalFilter filter_;
  std::vector<VoxelMap::Neighborhood> neighborhoods_;  // of the points used
};

}  // namespace fail_aware
