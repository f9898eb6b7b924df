#include "core/registration/beam_offsets.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace fail_aware {

void BeamOffsets::update(const std::vector<BeamEvidence>& evidence, const Eigen::MatrixXd& shared) {
  const double initial_variance = params_.sigma * params_.sigma;
  if (evidence.size() > values_.size()) {
    values_.resize(evidence.size(), 0.0f);
    variances_.resize(evidence.size(), initial_variance);
  }
  for (double& variance : variances_) variance = std::min(variance + params_.walk * params_.walk, initial_variance);
  std::vector<std::size_t> rings;
  for (std::size_t ring = 0; ring < evidence.size(); ++ring) {
    if (evidence[ring].information > 0.0) rings.push_back(ring);
  }
  const auto count = static_cast<Eigen::Index>(rings.size());
  if (count <= shared.cols()) return;  // the patterns explain whatever is observed
  Eigen::VectorXd observed(count), root(count);
  Eigen::MatrixXd patterns(count, shared.cols());
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::size_t ring = rings[static_cast<std::size_t>(i)];
    observed[i] = evidence[ring].residual / evidence[ring].information;
    root[i] = std::sqrt(evidence[ring].information);
    patterns.row(i) = shared.row(static_cast<Eigen::Index>(ring));
  }
  const Eigen::MatrixXd weighted = root.asDiagonal() * patterns;
  observed -= patterns * weighted.colPivHouseholderQr().solve(root.cwiseProduct(observed));
  if (!observed.allFinite()) return;
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::size_t ring = rings[static_cast<std::size_t>(i)];
    const double noise = params_.residual_m * params_.residual_m / evidence[ring].information;
    const double known = static_cast<double>(values_[ring]);
    const double gain = variances_[ring] / (variances_[ring] + noise);
    const double value = known + gain * (observed[i] - params_.forget * known);
    values_[ring] = static_cast<float>(std::clamp(value, -params_.limit, params_.limit));
    variances_[ring] *= 1.0 - gain;
  }
}

}  // namespace fail_aware
