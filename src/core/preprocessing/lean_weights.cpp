#include "core/preprocessing/lean_weights.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/robust_kernel.hpp"

namespace fail_aware {

namespace {

enum Kind : std::size_t { kSurface, kLine, kLowSurface, kKinds };

constexpr float kLowTop_m = 0.1f;  // above the sensor: hedges and cars end below a sensor at 1.7 m
constexpr double kKernelSigmas = 3.0;
constexpr double kEnoughOthers = 6.0;
// The curvature ratio of the residuals (robust_kernel.hpp) is 0.55 to 0.85 where things stand upright. Hedges and banks
// lean in all directions: the residuals have no peak at zero, and the ratio is 0.2 to 0.4. Neighbouring looks see the
// same scenery and share its error, so the variance grows with the cube of the inflation.
constexpr double kUsualCurvatureRatio = 0.5, kSharedLean = 3.0;
// In towns 0.6 to 0.75 of the profiles are inliers; of those of hedges 0.02 to 0.3 are, and they agree by chance.
constexpr double kUsualInlierRatio = 0.6, kLeastInlierRatio = 0.02, kAgreementByChance = 4.0;

Kind kindOf(const UprightProfile& profile) {
  if (profile.kind != UprightProfile::Kind::kSurface) return kLine;
  return profile.top_m < kLowTop_m ? kLowSurface : kSurface;
}

struct Residuals {
  double count = 0.0, weight = 0.0, curvature = 0.0;

  double inflation(bool predicted) const {
    const double curvature_ratio = curvature / std::max(weight, 1e-9);
    const double of_shape = std::pow(kernelInflation(curvature_ratio, kUsualCurvatureRatio), kSharedLean);
    if (predicted) return of_shape;
    const double inlier_ratio = std::clamp(weight / std::max(count, 1.0), kLeastInlierRatio, kUsualInlierRatio);
    return of_shape * std::pow(kUsualInlierRatio / inlier_ratio, kAgreementByChance);
  }
};

}  // namespace

LeanWeights leanWeights(const std::vector<UprightProfile>& profiles, const std::vector<ProfileEquations>& equations,
                        const Eigen::VectorXd& x, const Eigen::MatrixXd* P_predicted) {
  LeanWeights weights;
  std::array<Residuals, kKinds> all;
  for (std::size_t i = 0; i < equations.size(); ++i) {
    const ProfileEquations& e = equations[i];
    const double residual = e.lean_value - e.lean.dot(e.pick(x)), residual2 = residual * residual;
    const double kernel2 = kKernelSigmas * kKernelSigmas * (1.0 + (P_predicted ? e.leanVariance(*P_predicted) : 0.0));
    const double weight = gemanMcClureWeight(residual2, kernel2);
    weights.kernel.push_back(weight);
    Residuals& of_kind = all[kindOf(profiles[i])];
    of_kind.count += 1.0;
    of_kind.weight += weight;
    of_kind.curvature += weight * gemanMcClureCurvature(residual2, residual2, kernel2);
  }
  const bool others_suffice = all[kSurface].count + all[kLine].count >= kEnoughOthers;
  for (std::size_t i = 0; i < equations.size(); ++i) {
    const Kind kind = kindOf(profiles[i]);
    const bool waits = P_predicted && kind == kLowSurface && others_suffice;
    weights.lean.push_back(waits ? 0.0 : weights.kernel[i] / all[kind].inflation(P_predicted != nullptr));
  }
  return weights;
}

}  // namespace fail_aware
