#include "evaluation/quantile.hpp"

#include <gtest/gtest.h>

namespace fail_aware::quantile_test {
namespace {

TEST(Quantile, InterpolatesOrderStatistics) {
  const std::vector<double> values = {4.0, 1.0, 3.0, 2.0};
  EXPECT_DOUBLE_EQ(quantile(values, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(quantile(values, 1.0), 4.0);
  EXPECT_DOUBLE_EQ(quantile(values, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(quantile(values, 0.1), 1.3);
  EXPECT_DOUBLE_EQ(quantile({7.0}, 0.05), 7.0);
}

}  // namespace
}  // namespace fail_aware::quantile_test
