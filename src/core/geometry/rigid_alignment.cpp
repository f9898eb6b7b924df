#include "core/geometry/rigid_alignment.hpp"

#include <Eigen/SVD>
#include <cmath>
#include <cstddef>

namespace fail_aware {

namespace {

constexpr double kRelativeRankTolerance = 1e-6;  // of singular values, relative to the largest possible one

}  // namespace

std::optional<Pose> alignRigid(const std::vector<Eigen::Vector3d>& source, const std::vector<Eigen::Vector3d>& target,
                               const std::vector<double>& weights) {
  double total = 0.0;
  Eigen::Vector3d mean_source = Eigen::Vector3d::Zero(), mean_target = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < source.size(); ++i) {
    total += weights[i];
    mean_source += weights[i] * source[i];
    mean_target += weights[i] * target[i];
  }
  mean_source /= total;
  mean_target /= total;

  // W = sum w (target - mean)(source - mean)^T = U S V^T;  R = U diag(1, 1, det(U V^T)) V^T
  Eigen::Matrix3d W = Eigen::Matrix3d::Zero();
  double spread_source = 0.0, spread_target = 0.0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const Eigen::Vector3d a = source[i] - mean_source, b = target[i] - mean_target;
    W += weights[i] * b * a.transpose();
    spread_source += weights[i] * a.squaredNorm();
    spread_target += weights[i] * b.squaredNorm();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(W, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d& s = svd.singularValues();
  const double tolerance = kRelativeRankTolerance * std::sqrt(spread_source * spread_target);
  const double handedness = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  if (!(s(1) > tolerance && s(1) + handedness * s(2) > tolerance)) return std::nullopt;

  Pose T_target_source = Pose::Identity();
  T_target_source.linear() =
      svd.matrixU() * Eigen::Vector3d(1.0, 1.0, handedness).asDiagonal() * svd.matrixV().transpose();
  T_target_source.translation() = mean_target - T_target_source.linear() * mean_source;
  return T_target_source;
}

}  // namespace fail_aware
