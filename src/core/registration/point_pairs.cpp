#include "core/registration/point_pairs.hpp"

#include "core/geometry/rotation.hpp"
#include "core/map/near_side.hpp"
#include "core/parallel.hpp"
#include "core/robust_kernel.hpp"

namespace fail_aware {

namespace {

/// False: a pair with this surface informs on no direction.
template <class Inform>
bool forEachInformedDirection(const PlanePatch& surface, Inform inform) {
  if (surface.samples > 0.0f) {
    inform(surface.normal.cast<double>());
    return true;
  }
  if (!surface.post) return false;
  inform(Eigen::Vector3d::UnitX());
  inform(Eigen::Vector3d::UnitY());
  return true;
}

constexpr std::size_t kBlock = 1000;  // most points per block; blocks may run in parallel

// Sums over pairs: those of `equations`, and the inputs of the remaining ones.
struct PairSums {
  NormalEquations equations;
  double w = 0.0;
  Eigen::Vector3d w_arm = Eigen::Vector3d::Zero();
  Eigen::Matrix3d w_arm_arm = Eigen::Matrix3d::Zero();

  PairSums operator+(const PairSums& other) const {
    PairSums sum = *this;
    sum.w += other.w;
    sum.w_arm += other.w_arm;
    sum.w_arm_arm += other.w_arm_arm;
    NormalEquations& e = sum.equations;
    e.b += other.equations.b;
    e.information += other.equations.information;
    e.information_b += other.equations.information_b;
    e.information_weight += other.equations.information_weight;
    e.squared_error += other.equations.squared_error;
    e.curvature += other.equations.curvature;
    e.inliers += other.equations.inliers;
    return sum;
  }
};

// Residual e = p - (R q + t); a step changes it by -dt - dr x arm, arm = R q, so J = [I, -[arm]x] acts on -e.
// `surface`: that the partner lies on; null: the pair informs equally in all directions.
void addPair(const Eigen::Vector3d& arm, const VoxelMap::PointMatch& match, const PlanePatch* surface, double kernel2,
             PairSums& sums) {
  const double e2 = match.distance2_m2;  // weights: of the pair as it was found
  Eigen::Vector3d e = match.offset_m.cast<double>();
  if (surface != nullptr && surface->post) {
    e.head<2>() += nearSideShift(surface->first_view.cast<double>(), arm.head<2>().normalized());
  }
  const double w = gemanMcClureWeight(e2, kernel2);
  NormalEquations& equations = sums.equations;
  sums.w += w;
  sums.w_arm += w * arm;
  sums.w_arm_arm.selfadjointView<Eigen::Lower>().rankUpdate(arm, w);
  equations.b.head<3>() += w * e;
  equations.b.tail<3>() += w * arm.cross(e);
  equations.squared_error += w * e2;
  ++equations.inliers;
  if (surface == nullptr) {
    equations.curvature += w * gemanMcClureCurvature(e2 / 3.0, e2, kernel2);  // mean over all directions
    return;
  }
  double curvature = 0.0;
  int directions = 0;
  const auto inform = [&](const Eigen::Vector3d& n) {
    Vector6d J;
    J << n, arm.cross(n);
    equations.information.selfadjointView<Eigen::Lower>().rankUpdate(J, w);
    const double along = n.dot(e);
    equations.information_b += w * along * J;
    curvature += gemanMcClureCurvature(along * along, e2, kernel2);
    ++directions;
  };
  if (forEachInformedDirection(*surface, inform)) {
    equations.information_weight += w;
    equations.curvature += w * curvature / directions;
  }
}

NormalEquations equationsOf(const PairSums& sums, bool surface_information) {
  NormalEquations equations = sums.equations;
  equations.has_information = equations.slides = surface_information;
  equations.information = equations.information.selfadjointView<Eigen::Lower>();
  if (equations.information_weight > 0.0) {  // pairs with unknown surface inform as the others do
    const double all = sums.w / equations.information_weight;
    equations.information *= all;
    equations.information_b *= all;
    equations.curvature *= all;
    equations.information_weight = sums.w;
  }
  const Eigen::Matrix3d w_arm_arm = sums.w_arm_arm.selfadjointView<Eigen::Lower>();
  equations.H.topLeftCorner<3, 3>().diagonal().setConstant(sums.w);
  equations.H.topRightCorner<3, 3>() = -skew(sums.w_arm);
  equations.H.bottomLeftCorner<3, 3>() = skew(sums.w_arm);
  equations.H.bottomRightCorner<3, 3>() = w_arm_arm.trace() * Eigen::Matrix3d::Identity() - w_arm_arm;
  equations.weight = sums.w;
  equations.weight_unscaled = sums.w;
  return equations;
}

}  // namespace

NormalEquations PointPairs::linearize(std::size_t stride, const Pose& T_odom_cog, double kernel_m,
                                      Neighborhoods& neighborhoods) const {
  const Eigen::Matrix3d R = T_odom_cog.linear();
  const Eigen::Vector3d t = T_odom_cog.translation();
  const double kernel2 = kernel_m * kernel_m;
  // neither the blocks nor the order of their sums depends on the number of threads
  neighborhoods.resize((points_cog_.size() + stride - 1) / stride);
  const auto sums = sumByHalves<PairSums>(0, neighborhoods.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    PairSums of_block;
    VoxelMap::PointMatch match;
    for (std::size_t k = begin; k != end; ++k) {
      if (k + VoxelMap::kPrefetchAhead < end) map_.prefetchPoints(neighborhoods[k + VoxelMap::kPrefetchAhead]);
      const Eigen::Vector3d arm = R * points_cog_[k * stride].cast<double>();
      if (!map_.findNearest(arm + t, params_.max_distance_m, match, neighborhoods[k])) continue;
      addPair(arm, match, params_.surface_information ? &map_.surface(match.voxel) : nullptr, kernel2, of_block);
    }
    return of_block;
  });
  return equationsOf(sums, params_.surface_information);
}

std::optional<WeakHorizontal> PointPairs::weakHorizontal(std::size_t stride, const Pose& T_odom_cog, double kernel_m,
                                                         Neighborhoods& neighborhoods) const {
  if (!params_.surface_information) return std::nullopt;
  const NormalEquations equations = linearize(stride, T_odom_cog, kernel_m, neighborhoods);
  const std::optional<Eigen::Vector2d> weakest = weakDirection(
      equations.information.topLeftCorner<2, 2>(), equations.information_weight, params_.support.below_ratio);
  if (!weakest) return std::nullopt;
  InformationSupport support(params_.support);
  VoxelMap::PointMatch match;
  const double kernel2 = kernel_m * kernel_m;
  for (const Eigen::Vector3f& point : points_cog_) {
    const Eigen::Vector3d p = T_odom_cog * point.cast<double>();
    if (!map_.findNearest(p, params_.max_distance_m, match)) continue;
    const double w = gemanMcClureWeight(match.distance2_m2, kernel2);
    forEachInformedDirection(map_.surface(match.voxel), [&](const Eigen::Vector3d& n) {
      const double along = weakest->dot(n.head<2>());
      support.add(p, w * along * along);
    });
  }
  return WeakHorizontal{*weakest, support.countedRatio()};
}

}  // namespace fail_aware
