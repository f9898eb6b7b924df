#include "evaluation/clopper_pearson.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fail_aware::clopper_pearson_test {
namespace {

void expectInterval(std::size_t part, std::size_t whole, double low, double high, double level = 0.95) {
  const std::optional<Interval> interval = clopperPearson(part, whole, level);
  ASSERT_TRUE(interval);
  EXPECT_NEAR(interval->low, low, 5e-5) << part << " of " << whole;
  EXPECT_NEAR(interval->high, high, 5e-5) << part << " of " << whole;
}

// R: binom.test(k, n)$conf.int
TEST(ClopperPearson, KnownIntervals) {
  expectInterval(5, 10, 0.1871, 0.8129);
  expectInterval(1, 10, 0.0025, 0.4450);
  expectInterval(4, 20, 0.0573, 0.4366);
  expectInterval(16, 17, 0.7131, 0.9985);
}

TEST(ClopperPearson, NoneAndAllHaveAClosedForm) {
  for (const std::size_t whole : {1u, 3u, 100u}) {
    const double rest = 1.0 - std::pow(0.025, 1.0 / static_cast<double>(whole));
    expectInterval(0, whole, 0.0, rest);
    expectInterval(whole, whole, 1.0 - rest, 1.0);
  }
  expectInterval(0, 10, 0.0, 1.0 - std::pow(0.05, 0.1), 0.9);
}

TEST(ClopperPearson, ManyTrialsAreNearTheNormalInterval) {
  const std::optional<Interval> interval = clopperPearson(97000, 100000);
  const double sigma = std::sqrt(0.97 * 0.03 / 1e5);
  EXPECT_NEAR(interval->low, 0.97 - 1.96 * sigma, 2e-5);
  EXPECT_NEAR(interval->high, 0.97 + 1.96 * sigma, 2e-5);
}

TEST(ClopperPearson, NoTrialsNoInterval) { EXPECT_FALSE(clopperPearson(0, 0)); }

}  // namespace
}  // namespace fail_aware::clopper_pearson_test
