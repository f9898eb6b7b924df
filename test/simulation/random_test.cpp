#include "simulation/random.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fail_aware::random_test {
namespace {

TEST(Random, KnownValueOnEveryMachine) {
  EXPECT_EQ(mixBits(0), 0xe220a8397b1dcdafULL);  // SplitMix64's first output for seed 0
}

TEST(Random, MomentsOfUniformAndNormal) {
  RandomStream random(7);
  constexpr int kCount = 100000;
  double uniform = 0.0, normal = 0.0, normal2 = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double u = random.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    uniform += u;
    const double n = random.normal();
    ASSERT_LT(std::abs(n), 3.5);
    normal += n;
    normal2 += n * n;
  }
  EXPECT_NEAR(uniform / kCount, 0.5, 0.005);
  EXPECT_NEAR(normal / kCount, 0.0, 0.01);
  EXPECT_NEAR(normal2 / kCount, 1.0, 0.02);
}

TEST(Random, KeysMatterInEveryPlace) {
  EXPECT_NE(combineKeys(1, 2, 3), combineKeys(1, 3, 2));
  EXPECT_NE(combineKeys(1, 2), combineKeys(2, 1));
  RandomStream a(5), b(5), c(6);
  const auto first = a.bits();
  EXPECT_EQ(first, b.bits());
  EXPECT_NE(first, c.bits());
}

}  // namespace
}  // namespace fail_aware::random_test
