#include "core/geometry/rigid_alignment.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace fail_aware {

namespace {

constexpr double kRelativeRankTolerance = 1e-6;  // of singular values, relative to the largest possible one

}  // namespace

RigidAlignment alignRigid(const std::vector<Eigen::Vector3d>& source, const std::vector<Eigen::Vector3d>& target,
                          const std::vector<double>& weights) {
  RigidAlignment result;
  const std::size_t pairs = std::min(source.size(), target.size());
  const auto weightOf = [&](std::size_t i) {
    const double weight = i < weights.size() ? weights[i] : (weights.empty() ? 1.0 : 0.0);
    const bool usable = std::isfinite(weight) && weight > 0.0 && source[i].allFinite() && target[i].allFinite();
    return usable ? weight : 0.0;
  };

  double total = 0.0;
  Eigen::Vector3d mean_source = Eigen::Vector3d::Zero(), mean_target = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < pairs; ++i) {
    const double w = weightOf(i);
    if (w == 0.0) continue;
    total += w;
    mean_source += w * source[i];
    mean_target += w * target[i];
  }
  if (total <= 0.0) return result;
  mean_source /= total;
  mean_target /= total;

  // W = sum w (target - mean)(source - mean)^T = U S V^T;  R = U diag(1, 1, det(U V^T)) V^T
  Eigen::Matrix3d W = Eigen::Matrix3d::Zero();
  double spread_source = 0.0, spread_target = 0.0;
  for (std::size_t i = 0; i < pairs; ++i) {
    const double w = weightOf(i);
    if (w == 0.0) continue;
    const Eigen::Vector3d a = source[i] - mean_source, b = target[i] - mean_target;
    W += w * b * a.transpose();
    spread_source += w * a.squaredNorm();
    spread_target += w * b.squaredNorm();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(W, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d& s = svd.singularValues();
  const double tolerance = kRelativeRankTolerance * std::sqrt(spread_source * spread_target);
  result.rank = tolerance > 0.0 ? static_cast<int>((s.array() > tolerance).count()) : 0;

  const double handedness = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  result.unique = result.rank >= 2 && s(1) + handedness * s(2) > tolerance;
  if (!result.unique) return result;

  const Eigen::Matrix3d R =
      svd.matrixU() * Eigen::Vector3d(1.0, 1.0, handedness).asDiagonal() * svd.matrixV().transpose();
  result.T_target_source.linear() = R;
  result.T_target_source.translation() = mean_target - R * mean_source;

  double squares = 0.0;
  for (std::size_t i = 0; i < pairs; ++i) {
    const double w = weightOf(i);
    if (w > 0.0) squares += w * (target[i] - result.T_target_source * source[i]).squaredNorm();
  }
  result.rms_m = std::sqrt(squares / total);
  return result;
}

}  // namespace fail_aware
