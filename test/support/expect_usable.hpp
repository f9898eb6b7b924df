// What every measurement must be, for the registration tests.
#pragma once

#include <gtest/gtest.h>

#include "core/geometry/decompositions.hpp"
#include "core/types/measurement.hpp"

namespace fail_aware {

/// A pose and a covariance that the fusion can use.
inline void expectUsable(const Measurement& m) {
  EXPECT_TRUE(isFinite(m.T_odom_cog));
  ASSERT_TRUE(m.covariance.allFinite());
  EXPECT_LT((m.covariance - m.covariance.transpose()).norm(), 1e-9);
  EXPECT_GT(symmetricEigenvalues(m.covariance)[0], 0.0);
}

}  // namespace fail_aware
