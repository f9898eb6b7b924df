#include "fail_aware_lidar_odometry/core/registration/normal_filtered_icp.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "fail_aware_lidar_odometry/core/geometry/rotation.hpp"
#include "fail_aware_lidar_odometry/core/parameters/check.hpp"

namespace fail_aware {

namespace {

constexpr double kDegree = M_PI / 180.0;

// Which plane patches may take part, given the predicted heading.
class NormalFilter {
 public:
  NormalFilter(const NormalFilteredIcp::Params& params, double heading_rad, double sigma_yaw_rad)
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

bool stepWithin(const Vector6d& step, const NormalFilteredIcp::Params& params, double factor) {
  return step.head<3>().norm() < factor * params.step_translation_m &&
         step.tail<3>().norm() < factor * params.step_rotation_deg * kDegree;
}

}  // namespace

void NormalFilteredIcp::Params::validate() const {
  requireWithin("heading_tolerance_deg", heading_tolerance_deg, 0.0, 45.0);
  requireWithin("ground_tolerance_deg", ground_tolerance_deg, 0.0, 90.0);
  requireWithin("vertical_tolerance_deg", vertical_tolerance_deg, 0.0, 90.0);
  requirePositive("max_distance_m", max_distance_m);
  requirePositive("kernel_m", kernel_m);
  requirePositive("initial_kernel_m", initial_kernel_m);
  requirePositive("point_sigma_m", point_sigma_m);
  requirePositive("ground_weight", ground_weight);
  requireNotNegative("range_weight_m", range_weight_m);
  requireWithin("max_iterations", max_iterations, 1, 1000);
  requirePositive("step_translation_m", step_translation_m);
  requirePositive("step_rotation_deg", step_rotation_deg);
  requireWithin("usable_steps", usable_steps, 1.0, 1e6);
  requireWithin("min_inliers", min_inliers, 6, 1e9);
  requireWithin("correlation_inflation", correlation_inflation, 1.0, 1e6);
  support.validate();
  observability.validate();
}

NormalFilteredIcp::NormalFilteredIcp(const Params& params) : params_(params) { params_.validate(); }

Measurement NormalFilteredIcp::align(const std::vector<Eigen::Vector3f>& points_cog, const VoxelMap& map,
                                     const Pose& T_odom_cog_predicted, double sigma_yaw_rad) const {
  Measurement result;
  result.T_odom_cog = T_odom_cog_predicted;
  if (map.empty()) return result;
  const NormalFilter filter(params_, rpyFromRotation(T_odom_cog_predicted.linear()).z(), sigma_yaw_rad);
  const double point_variance = params_.point_sigma_m * params_.point_sigma_m;
  const auto max_distance = static_cast<float>(params_.max_distance_m);

  const auto linearize = [&](const Pose& T, double kernel_m, const Eigen::Vector2d* direction,
                             InformationSupport* support) {
    const double kernel2 = kernel_m * kernel_m;
    NormalEquations equations;
    const Eigen::Matrix3d R = T.linear();
    const Eigen::Vector3d t = T.translation();
    VoxelMap::PlaneMatch match;
    for (const Eigen::Vector3f& q : points_cog) {
      const Eigen::Vector3d arm = R * q.cast<double>();
      if (!map.findPlane(arm + t, match)) continue;
      if (!(std::abs(match.distance_m) <= max_distance) || !filter.keeps(match.normal)) continue;
      // r = n . (R q + t - mean), dr/d(dt) = n, dr/d(dr) = arm x n
      const double r = match.distance_m;
      const Eigen::Vector3d n = match.normal.cast<double>();
      Vector6d J;
      J << n, arm.cross(n);
      const double kernel = kernel2 / (kernel2 + r * r);
      const double w = kernel * kernel;
      double scaled = w / (point_variance + match.variance);
      if (filter.isGround(match.normal)) scaled *= params_.ground_weight;
      if (params_.range_weight_m > 0.0) scaled *= static_cast<double>(q.norm()) / params_.range_weight_m;
      equations.H.selfadjointView<Eigen::Lower>().rankUpdate(J, scaled);
      equations.b -= scaled * r * J;
      equations.weight += scaled;
      equations.weight_unscaled += w;
      equations.squared_error += w * r * r;
      ++equations.inliers;
      if (support) {
        const double along = direction->dot(n.head<2>());
        support->add(arm + t, scaled * along * along);
      }
    }
    equations.H = equations.H.selfadjointView<Eigen::Lower>();
    return equations;
  };

  Pose T = T_odom_cog_predicted;
  NormalEquations equations;
  bool converged = false;
  Vector6d step = Vector6d::Zero();
  double kernel_m = std::max(params_.initial_kernel_m, params_.kernel_m);
  std::optional<Eigen::Vector2d> weak_direction;
  double counted_share = 1.0;
  for (result.iterations = 1; result.iterations <= params_.max_iterations; ++result.iterations) {
    equations = linearize(T, kernel_m, nullptr, nullptr);
    if (static_cast<int>(equations.inliers) < params_.min_inliers) {
      result.status = MeasurementStatus::kTooFewPoints;
      return result;
    }
    if (result.iterations == 1) {
      const Eigen::Matrix2d horizontal = equations.H.topLeftCorner<2, 2>();
      const Eigen::Vector2d weakest = weakestHorizontal(horizontal);
      if (weakest.dot(horizontal * weakest) < params_.support.below_share * equations.weight) {
        InformationSupport support(params_.support);
        linearize(T, kernel_m, &weakest, &support);
        weak_direction = weakest;
        counted_share = support.countedShare();
      }
    }
    if (weak_direction) discount(equations, *weak_direction, counted_share);
    const Solution solution = solveObserved(equations, params_.observability);
    result.weak_directions = solution.weak_directions;
    result.min_information_share = solution.min_horizontal_share;
    if (solution.weak_directions == 6) {
      result.status = MeasurementStatus::kDegenerate;
      return result;
    }
    step = solution.dx;
    T = applyStep(T, step);
    if (kernel_m <= params_.kernel_m && stepWithin(step, params_, 1.0)) {
      converged = true;
      break;
    }
    kernel_m = std::max(0.5 * kernel_m, params_.kernel_m);
  }
  result.iterations = std::min(result.iterations, params_.max_iterations);
  result.T_odom_cog = T;
  result.inliers = equations.inliers;
  result.inlier_share = static_cast<double>(equations.inliers) / static_cast<double>(points_cog.size());
  result.rms_residual_m = std::sqrt(equations.squared_error / std::max(equations.weight_unscaled, 1e-9));
  result.covariance = covarianceObserved(equations, params_.correlation_inflation, params_.observability);
  const bool usable = converged || stepWithin(step, params_, params_.usable_steps) ||
                      isWithinSigma(step, result.covariance);  // wanders where little is observed
  result.status = usable ? MeasurementStatus::kOk : MeasurementStatus::kNotConverged;
  if (!converged) result.covariance += step * step.transpose();
  return result;
}

}  // namespace fail_aware
