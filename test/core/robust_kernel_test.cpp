#include "core/robust_kernel.hpp"

#include <gtest/gtest.h>

namespace fail_aware {
namespace {

TEST(RobustKernel, CurvatureIsTheDerivativeOfTheWeightedResidual) {
  constexpr double kScale2 = 0.09, kStep = 1e-6;
  const auto weighted = [&](double r) { return r * gemanMcClureWeight(r * r, kScale2); };
  for (const double r : {0.0, 0.05, 0.17, 0.3, 1.0, 3.0}) {
    const double w = gemanMcClureWeight(r * r, kScale2);
    const double along = (weighted(r + kStep) - weighted(r - kStep)) / (2.0 * kStep);
    EXPECT_NEAR(w * gemanMcClureCurvature(w, 1.0), along, 1e-8) << r;
    // across the residual the weighted residual turns with it: its derivative is the weight
    EXPECT_NEAR(w * gemanMcClureCurvature(w, 1.0 / 3.0), (along + 2.0 * w) / 3.0, 1e-8) << r;
  }
}

}  // namespace
}  // namespace fail_aware
