#include "core/integrity/growth_rate.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fail_aware::growth_rate_test {
namespace {

constexpr double kPeriod_s = 0.1, kWeak = 0.01;

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
  growth_rate.describe(kWeak, growth);
  EXPECT_TRUE(growth.rate.isZero());
  EXPECT_EQ(growth.speed_share, 0.0);
}

TEST(GrowthRate, SteadySpeedErrorIsForgottenAsFastAsMade) {
  GrowthRate growth_rate(3.0);
  for (int i = 0; i < 20; ++i) growth_rate.add(rateOf(0.01, 0.2), {0.16, 0.16, 0.85}, kPeriod_s);
  CovarianceGrowth growth;
  growth_rate.describe(kWeak, growth);
  EXPECT_NEAR(growth.rate(0, 0), 0.1, 1e-12);
  EXPECT_EQ(growth.speed_share, 0.2);
  EXPECT_NEAR(growth.speed_forgotten_per_s, -std::log(0.85) / kPeriod_s, 1e-12);
  EXPECT_NEAR(growth.speed_noise, 2.0 * growth.speed_forgotten_per_s * 0.16, 1e-12);
}

TEST(GrowthRate, KeptSpeedErrorGrowsByItsNoise) {
  GrowthRate growth_rate(3.0);
  for (int i = 0; i < 20; ++i) growth_rate.add(rateOf(0.01, 1.0), {0.1 * i, 0.1 * (i + 1), 1.0}, kPeriod_s);
  CovarianceGrowth growth;
  growth_rate.describe(kWeak, growth);
  EXPECT_EQ(growth.speed_forgotten_per_s, 0.0);
  EXPECT_NEAR(growth.speed_noise, 1.0, 1e-12);
}

TEST(GrowthRate, AWeakStretchAheadGrowsAsOne) {
  GrowthRate growth_rate(3.0);
  DriftRate rate = rateOf(0.01, 0.01);
  rate.on_weak_stretch = {2e-5, 0.05};
  const auto stretchAfter = [&](int sweeps, const InformationAhead& ahead) {
    for (int i = 0; i < sweeps; ++i) {
      growth_rate.add(rate, {}, kPeriod_s);
      growth_rate.lookAhead(ahead);
    }
    CovarianceGrowth growth;
    growth_rate.describe(kWeak, growth);
    return growth.weak_stretch;
  };
  EXPECT_FALSE(stretchAfter(9, {}));
  const auto weak = stretchAfter(9, {0.001, 50.0});
  ASSERT_TRUE(weak);
  EXPECT_EQ(weak->distance_m, 50.0);
  EXPECT_NEAR(weak->rate, 2e-4, 1e-12);
  EXPECT_EQ(weak->speed_share, 0.05);
  EXPECT_GT(weak->speed_variance, 0.0);
  EXPECT_FALSE(stretchAfter(9, {0.003, 50.0}));
}

TEST(GrowthRate, OneBlindedSweepSaysNothingOfTheFuture) {
  GrowthRate growth_rate(3.0);
  for (int i = 0; i < 10; ++i) growth_rate.add(rateOf(0.01, 0.05), {}, kPeriod_s);
  growth_rate.add(rateOf(0.01, 1.0), {0.0, 1.0, 1.0}, kPeriod_s);
  CovarianceGrowth growth;
  growth_rate.describe(kWeak, growth);
  EXPECT_EQ(growth.speed_share, 0.05);
  EXPECT_EQ(growth.speed_noise, 0.0);
  growth_rate.reset();
  EXPECT_FALSE(growth_rate.known());
}

TEST(GrowthRate, WhatARegistrationTookBackIsNotTheFuture) {
  GrowthRate growth_rate(3.0);
  const auto rateAfter = [&](double variance, bool open) {
    DriftRate rate = rateOf(variance, 0.0);
    rate.open = open;
    growth_rate.add(rate, {}, kPeriod_s);
    CovarianceGrowth growth;
    growth_rate.describe(kWeak, growth);
    return growth.rate(0, 0);
  };
  for (int i = 0; i < 40; ++i) rateAfter(0.01, false);
  EXPECT_NEAR(rateAfter(1.0, true), 0.1, 1e-9) << "one sweep";
  EXPECT_NEAR(rateAfter(1.0, true), 0.1, 1e-9);
  EXPECT_GT(rateAfter(1.0, true), 1.0) << "0.3 s";
  EXPECT_GT(rateAfter(1.0, true), 1.0);
  EXPECT_NEAR(rateAfter(0.01, false), 0.1, 1e-9) << "measured again";
  EXPECT_NEAR(rateAfter(1.0, true), 0.1, 1e-9) << "a single one again";
  growth_rate.reset();
  EXPECT_NEAR(rateAfter(1.0, true), 10.0, 1e-9) << "nothing else is known";
  growth_rate.reset();
  EXPECT_FALSE(growth_rate.known());
}

}  // namespace
}  // namespace fail_aware::growth_rate_test
