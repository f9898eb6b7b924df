#include "core/robust_kernel.hpp"

#include <gtest/gtest.h>

namespace fail_aware::robust_kernel_test {
namespace {

TEST(RobustKernel, CurvatureIsTheDerivativeOfTheWeightedResidual) {
  constexpr double kScale2 = 0.09, kStep = 1e-6;
  const auto weighted = [&](double r) { return r * gemanMcClureWeight(r * r, kScale2); };
  for (const double r : {0.0, 0.05, 0.17, 0.3, 1.0, 3.0}) {
    const double r2 = r * r, w = gemanMcClureWeight(r2, kScale2);
    const double along = (weighted(r + kStep) - weighted(r - kStep)) / (2.0 * kStep);
    EXPECT_NEAR(w * gemanMcClureCurvature(r2, r2, kScale2), along, 1e-8) << r;
    // across the residual the weighted residual turns with it: its derivative is the weight
    EXPECT_NEAR(w * gemanMcClureCurvature(r2 / 3.0, r2, kScale2), (along + 2.0 * w) / 3.0, 1e-8) << r;
  }
}

TEST(RobustKernel, ResidualsOnTheFlanksInflate) {
  for (const double usual : {1.0, 0.75, 0.6}) EXPECT_EQ(kernelInflation(usual, 0.6), 1.0);
  EXPECT_NEAR(kernelInflation(0.3, 0.6), 4.0, 1e-12);
  EXPECT_NEAR(kernelInflation(-0.5, 0.6), 900.0, 1e-9);
  EXPECT_EQ(kernelInflation(0.3, 0.0), 1.0) << "switched off";
}

}  // namespace
}  // namespace fail_aware::robust_kernel_test
