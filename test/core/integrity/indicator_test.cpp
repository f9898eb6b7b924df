#include "core/integrity/indicator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::indicator_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

FailAwareIndicator::Params paramsWith(double threshold, int window) {
  FailAwareIndicator::Params params;
  params.threshold = threshold;
  params.rate_window_samples = window;
  params.average_s = 0.0;
  params.reference_speed_mps = 0.0;
  return params;
}

TEST(FailAwareIndicator, SumsSecondDifferences) {
  FailAwareIndicator indicator(paramsWith(1.0, 1));
  const double sigmas[] = {0.010, 0.012, 0.011, 0.015, 0.015};
  indicator.start(100.0);
  for (int i = 0; i < 5; ++i) indicator.update(100.0 + 0.1 * i, sigmas[i], 0.0);
  EXPECT_NEAR(indicator.eta(), 0.003 + 0.005 + 0.004, 1e-9);
  ASSERT_TRUE(indicator.etaRate());
  EXPECT_NEAR(*indicator.etaRate(), 0.004 / 0.1, 1e-6);
  EXPECT_NEAR(indicator.timeToFailure().seconds, (1.0 - 0.012) / 0.04, 1e-4);
}

TEST(FailAwareIndicator, TheRateIsAveragedOverItsWindow) {
  FailAwareIndicator indicator(paramsWith(1.0, 2));
  const double sigmas[] = {0.010, 0.012, 0.011, 0.015, 0.015};
  indicator.start(0.0);
  for (int i = 0; i < 5; ++i) indicator.update(0.1 * i, sigmas[i], 0.0);
  EXPECT_NEAR(*indicator.etaRate(), (0.005 + 0.004) / 0.2, 1e-9);
}

TEST(FailAwareIndicator, NeedsThreeSamples) {
  FailAwareIndicator indicator(paramsWith(0.1, 5));
  EXPECT_EQ(indicator.timeToFailure().status, TimeToFailureStatus::kUnknown);
  indicator.update(0.0, 0.01, 0.0);
  indicator.start(1.0);
  indicator.update(0.9, 0.01, 0.0);
  indicator.update(1.0, 0.01, 0.0);
  EXPECT_EQ(indicator.timeToFailure().status, TimeToFailureStatus::kUnknown);
  indicator.update(1.1, 0.01, 0.0);
  EXPECT_EQ(indicator.timeToFailure().status, TimeToFailureStatus::kUnknown);
  EXPECT_EQ(indicator.timeToFailure().seconds, -1.0);
  EXPECT_FALSE(indicator.etaRate());
  indicator.update(1.2, 0.011, 0.0);
  EXPECT_EQ(indicator.timeToFailure().status, TimeToFailureStatus::kWithinHorizon);
}

TEST(FailAwareIndicator, SteadySigmaIsBeyondTheHorizon) {
  for (const double slope : {0.0, 0.25}) {  // exact in binary at these stamps
    FailAwareIndicator indicator(paramsWith(0.001, 20));
    indicator.start(0.0);
    for (int i = 0; i < 100; ++i) indicator.update(0.125 * i, slope * 0.125 * i, 0.0);
    EXPECT_EQ(indicator.eta(), 0.0);
    EXPECT_EQ(indicator.timeToFailure().status, TimeToFailureStatus::kBeyondHorizon);
    EXPECT_EQ(indicator.timeToFailure().seconds, 60.0);
  }
}

TEST(FailAwareIndicator, TheThresholdsEdge) {
  // second difference 0.25 in each step
  const double sigmas[] = {0.0, 0.0, 0.25, 0.75};
  FailAwareIndicator::Params params = paramsWith(0.5, 1);
  params.reference_period_s = 0.125;
  FailAwareIndicator indicator(params);
  indicator.start(0.0);
  for (int i = 0; i < 3; ++i) indicator.update(0.125 * i, sigmas[i], 0.0);
  EXPECT_EQ(indicator.eta(), 0.25);
  EXPECT_EQ(indicator.timeToFailure().seconds, 0.125);
  indicator.update(0.375, sigmas[3], 0.0);
  EXPECT_EQ(indicator.eta(), 0.5);
  EXPECT_EQ(indicator.timeToFailure().status, TimeToFailureStatus::kReached);
  EXPECT_EQ(indicator.timeToFailure().seconds, 0.0);
}

TEST(FailAwareIndicator, TheHorizonsEdge) {
  FailAwareIndicator::Params params = paramsWith(0.5, 1);
  params.reference_period_s = 0.125;
  for (const double horizon : {0.125, 0.126}) {
    params.horizon_s = horizon;
    FailAwareIndicator indicator(params);
    indicator.start(0.0);
    indicator.update(0.0, 0.0, 0.0);
    indicator.update(0.125, 0.0, 0.0);
    indicator.update(0.25, 0.25, 0.0);  // 0.125 s left
    EXPECT_EQ(indicator.timeToFailure().status == TimeToFailureStatus::kBeyondHorizon, horizon == 0.125);
    EXPECT_EQ(indicator.timeToFailure().seconds, 0.125);
  }
}

TEST(FailAwareIndicator, ASmoothSigmaGivesTheSameAtAnySpacing) {
  // total variation of d/dt (0.01 + 0.002 sin(w t)) over whole periods is 4 * 0.002 w each
  const double w = 2.0 * M_PI / 4.0, duration = 40.0;
  const double expected = 0.1 * 10.0 * 4.0 * 0.002 * w;
  std::mt19937 random(2);
  std::uniform_real_distribution<double> jitter(0.5, 1.5);
  for (const double period : {0.05, 0.1, 0.2}) {
    for (const bool irregular : {false, true}) {
      FailAwareIndicator indicator(paramsWith(10.0, 20));
      indicator.start(0.0);
      for (double t = 0.0; t < duration; t += irregular ? period * jitter(random) : period) {
        indicator.update(t, 0.01 + 0.002 * std::sin(w * t), 0.0);
      }
      EXPECT_NEAR(indicator.eta(), expected, 0.02 * expected) << period << irregular;
    }
  }
}

TEST(FailAwareIndicator, MeansAreWeightedWithTheirSpeed) {
  FailAwareIndicator::Params params = paramsWith(1.0, 10);
  params.average_s = 0.4;
  params.reference_speed_mps = 10.0;
  params.reference_period_s = 0.1;
  FailAwareIndicator indicator(params);
  indicator.start(0.0);
  const double means[] = {0.01, 0.02, 0.02, 0.05};  // slopes 0.025, 0, 0.075 rad/s
  const double speeds[] = {0.0, 7.0, 20.0, 5.0};
  for (int i = 0; i < 17; ++i) {
    const int mean = std::min(i / 4, 3);
    const double jitter = i % 2 ? 0.004 : -0.004;
    indicator.update(0.1 * i, means[mean] + jitter, speeds[mean]);
    if (i < 12) {
      EXPECT_EQ(indicator.eta(), 0.0) << "the third mean is complete when the fourth begins";
    }
  }
  EXPECT_NEAR(indicator.eta(), 0.1 * (2.0 * 0.025 + 0.5 * 0.075), 1e-12);
}

TEST(FailAwareIndicator, TheTimeCountsFromTheLastStamp) {
  FailAwareIndicator::Params params = paramsWith(1.0, 10);
  params.average_s = 1.0;
  FailAwareIndicator indicator(params);
  indicator.start(0.0);
  double reached_s = -1.0;
  std::vector<double> reached_at_s;  // as told each sweep
  for (int i = 0; reached_s < 0.0 && i < 1000; ++i) {
    const double stamp_s = 0.1 * i;
    // each second's mean another one: eta grows by the same each second
    indicator.update(stamp_s, 0.1 * (1 + i / 10 % 2), 0.0);
    const TimeToFailure time = indicator.timeToFailure();
    if (time.status == TimeToFailureStatus::kReached) reached_s = stamp_s;
    if (time.status == TimeToFailureStatus::kWithinHorizon) reached_at_s.push_back(stamp_s + time.seconds);
  }
  ASSERT_GT(reached_s, 0.0);
  ASSERT_GT(reached_at_s.size(), 30u);
  for (const double told_s : reached_at_s)
    EXPECT_NEAR(told_s, reached_s, 1.6) << "a mean is known when its second is over";
  for (std::size_t i = 1; i < reached_at_s.size(); ++i) EXPECT_NEAR(reached_at_s[i], reached_at_s[i - 1], 0.11);
}

TEST(FailAwareIndicator, StampsThatDoNotAdvanceAreIgnored) {
  FailAwareIndicator with(paramsWith(1.0, 5)), without(paramsWith(1.0, 5));
  with.start(0.0);
  without.start(0.0);
  for (int i = 0; i < 10; ++i) {
    const double sigma = 0.01 + 0.001 * (i % 3);
    with.update(0.1 * i, sigma, 0.0);
    without.update(0.1 * i, sigma, 0.0);
    with.update(0.1 * i, 0.5, 0.0);
    with.update(0.1 * i + 0.001, 0.5, 0.0);
    if (i > 2) with.update(0.1 * i - 0.2, 0.5, 0.0);
    with.update(0.1 * i + 0.05, kNan, 0.0);
    with.update(0.1 * i + 0.05, -0.1, 0.0);
    with.update(kNan, 0.01, 0.0);
    with.update(kInfinity, 0.01, 0.0);
  }
  EXPECT_EQ(with.eta(), without.eta());
  EXPECT_EQ(with.etaRate(), without.etaRate());
}

TEST(FailAwareIndicator, AGapKeepsEtaButNotTheRate) {
  FailAwareIndicator indicator(paramsWith(1.0, 5));
  indicator.start(0.0);
  for (int i = 0; i < 5; ++i) indicator.update(0.1 * i, 0.01 + 0.001 * (i % 2), 0.0);
  const double eta = indicator.eta();
  EXPECT_GT(eta, 0.0);
  indicator.update(5.0, 0.3, 0.0);
  EXPECT_EQ(indicator.eta(), eta);
  EXPECT_EQ(indicator.timeToFailure().status, TimeToFailureStatus::kUnknown);
  indicator.update(5.1, 0.3, 0.0);
  EXPECT_EQ(indicator.timeToFailure().status, TimeToFailureStatus::kUnknown);
  indicator.update(5.2, 0.3, 0.0);
  EXPECT_EQ(indicator.eta(), eta);
  EXPECT_EQ(indicator.timeToFailure().status, TimeToFailureStatus::kBeyondHorizon);
}

TEST(FailAwareIndicator, StartClearsAndStopForgets) {
  FailAwareIndicator indicator(paramsWith(0.001, 5));
  indicator.start(0.0);
  for (int i = 0; i < 5; ++i) indicator.update(0.1 * i, 0.01 * (i % 2), 0.0);
  EXPECT_EQ(indicator.timeToFailure().status, TimeToFailureStatus::kReached);
  indicator.start(-5.0);  // a loop in the recording
  EXPECT_EQ(indicator.eta(), 0.0);
  indicator.update(-5.0, 0.01, 0.0);
  EXPECT_EQ(indicator.timeToFailure().status, TimeToFailureStatus::kUnknown);
  indicator.stop();
  EXPECT_FALSE(indicator.started());
  indicator.start(kNan);
  EXPECT_FALSE(indicator.started());
}

TEST(FailAwareIndicator, NeverNanAndEtaNeverFalls) {
  std::mt19937 random(17);
  std::uniform_int_distribution<int> kind(0, 19);
  std::uniform_real_distribution<double> uniform(-0.2, 1.0);
  const double strange[] = {kNan, kInfinity, -kInfinity, 0.0, std::numeric_limits<double>::max(), -1.0, 1e-300};
  for (int run = 0; run < 50; ++run) {
    FailAwareIndicator::Params params = paramsWith(run % 2 ? 1e-3 : 1e9, 1 + run % 7);
    if (run % 3) params.average_s = 2.0, params.reference_speed_mps = 10.0;
    FailAwareIndicator indicator(params);
    if (run % 5) indicator.start(0.0);
    double t = 0.0, eta = 0.0;
    for (int i = 0; i < 400; ++i) {
      t += uniform(random);
      const double stamp = kind(random) == 0 ? strange[kind(random) % 7] : t;
      const double sigma = kind(random) < 3 ? strange[kind(random) % 7] : std::abs(uniform(random));
      indicator.update(stamp, sigma, run % 3 ? strange[kind(random) % 7] : 0.0);
      const TimeToFailure time = indicator.timeToFailure();
      ASSERT_TRUE(std::isfinite(indicator.eta()) && indicator.eta() >= eta);
      eta = indicator.eta();
      ASSERT_TRUE(!indicator.etaRate() || (std::isfinite(*indicator.etaRate()) && *indicator.etaRate() >= 0.0));
      ASSERT_TRUE(time.seconds == -1.0 || (time.seconds >= 0.0 && time.seconds <= params.horizon_s));
      ASSERT_EQ(time.isKnown(), time.seconds != -1.0);
    }
  }
}

TEST(FailAwareIndicator, ParametersAreChecked) {
  EXPECT_THROW(validate(paramsWith(0.0, 1)), ParameterError);
  EXPECT_THROW(validate(paramsWith(0.1, 0)), ParameterError);
}

}  // namespace
}  // namespace fail_aware::indicator_test
