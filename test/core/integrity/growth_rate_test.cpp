#include "core/integrity/growth_rate.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fail_aware {
namespace {

constexpr double kPeriod_s = 0.1;

DriftRate rateOf(double variance, double speed_share) {
  DriftRate rate;
  rate.covariance.diagonal().setConstant(variance);
  rate.speed_share = speed_share;
  return rate;
}

TEST(GrowthRate, IsUnknownBeforeTheFirstSweep) {
  GrowthRate growth_rate(3.0);
  EXPECT_FALSE(growth_rate.known());
  growth_rate.add(rateOf(1.0, 0.5), {}, 0.0);
  EXPECT_FALSE(growth_rate.known()) << "no interval";
  CovarianceGrowth growth;
  growth_rate.describe(growth);
  EXPECT_TRUE(growth.rate.isZero());
  EXPECT_EQ(growth.speed_share, 0.0);
}

TEST(GrowthRate, SteadySpeedErrorIsForgottenAsFastAsMade) {
  GrowthRate growth_rate(3.0);
  for (int i = 0; i < 20; ++i) growth_rate.add(rateOf(0.01, 0.2), {0.16, 0.16, 0.85}, kPeriod_s);
  CovarianceGrowth growth;
  growth_rate.describe(growth);
  EXPECT_NEAR(growth.rate(0, 0), 0.1, 1e-12);
  EXPECT_EQ(growth.speed_share, 0.2);
  EXPECT_NEAR(growth.speed_forgotten_per_s, -std::log(0.85) / kPeriod_s, 1e-12);
  EXPECT_NEAR(growth.speed_noise, 2.0 * growth.speed_forgotten_per_s * 0.16, 1e-12);
}

TEST(GrowthRate, KeptSpeedErrorGrowsByItsNoise) {
  GrowthRate growth_rate(3.0);
  for (int i = 0; i < 20; ++i) growth_rate.add(rateOf(0.01, 1.0), {0.1 * i, 0.1 * (i + 1), 1.0}, kPeriod_s);
  CovarianceGrowth growth;
  growth_rate.describe(growth);
  EXPECT_EQ(growth.speed_forgotten_per_s, 0.0);
  EXPECT_NEAR(growth.speed_noise, 1.0, 1e-12);
}

TEST(GrowthRate, OneBlindedSweepSaysNothingOfTheFuture) {
  GrowthRate growth_rate(3.0);
  for (int i = 0; i < 10; ++i) growth_rate.add(rateOf(0.01, 0.05), {}, kPeriod_s);
  growth_rate.add(rateOf(0.01, 1.0), {0.0, 1.0, 1.0}, kPeriod_s);
  CovarianceGrowth growth;
  growth_rate.describe(growth);
  EXPECT_EQ(growth.speed_share, 0.05);
  EXPECT_EQ(growth.speed_noise, 0.0);
  growth_rate.reset();
  EXPECT_FALSE(growth_rate.known());
}

}  // namespace
}  // namespace fail_aware
