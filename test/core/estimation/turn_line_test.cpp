#include "core/estimation/turn_line.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "simulation/random.hpp"

namespace fail_aware::turn_line_test {
namespace {

TEST(TurnLine, PeriodComesFromThreeIntervals) {
  TurnLine line;
  EXPECT_TRUE(line.empty());
  for (int i = 0; i < 3; ++i) {
    line.add(i, 0.1 * i, 0.003);
    EXPECT_EQ(line.period_s(), 0.0);
  }
  line.add(3, 0.3, 0.003);
  EXPECT_NEAR(line.period_s(), 0.1, 1e-12);
  EXPECT_NEAR(line.at(5), 0.5, 1e-12);
}

TEST(TurnLine, KnownPeriodCountsByItsSigma) {
  TurnLine line;
  line.restart(0.101, 1e-4);
  line.add(0, 0.0, 0.01);
  line.add(1, 0.09, 0.01);
  EXPECT_NEAR(line.period_s(), 0.101, 1e-5);
  EXPECT_LT(line.periodSigma_s(), 1e-4);
}

TEST(TurnLine, PeriodAndPhaseAreAsSureAsTheySay) {
  RandomStream random(3);
  const double noise_s = 0.01;
  double period = 0.0, phase = 0.0;
  const int drives = 200;
  for (int drive = 0; drive < drives; ++drive) {
    TurnLine line;
    line.restart(0.1, 0.05);
    for (int i = 0; i < 60; ++i) line.add(i, 0.1 * i + noise_s * random.normal(), noise_s);
    period += std::pow((line.period_s() - 0.1) / line.periodSigma_s(), 2) / drives;
    const double stamp_s = 6.0 + noise_s * random.normal();
    phase += std::pow((stamp_s - line.at(60)) / (noise_s * line.predictionFactor(60)), 2) / drives;
  }
  EXPECT_NEAR(period, 1.0, 0.4);
  EXPECT_NEAR(phase, 1.0, 0.4);
}

TEST(TurnLine, FirstCountsAreMadeAnew) {
  TurnLine line;
  const double stamps_s[] = {0.0,  0.06, 0.12, 0.17, 0.27, 0.37,
                             0.47, 0.57, 0.67, 0.77, 0.87};  // a head that slows down
  double turn = 0.0;
  for (double stamp_s : stamps_s) line.add(turn += 2.0, stamp_s, 0.001);
  EXPECT_NEAR(line.period_s(), 0.1, 0.002);
}

TEST(TurnLine, OtherRateIsTakenOver) {
  TurnLine line;
  line.restart(0.1, 0.001);
  double stamp_s = 0.0;
  for (int i = 0; i < 40; ++i) line.add(i, stamp_s += 0.1, 1e-4);
  for (int i = 40; i < 60; ++i) line.add(i, stamp_s += 0.101, 1e-4);
  EXPECT_NEAR(line.period_s(), 0.101, 3e-5);
}

}  // namespace
}  // namespace fail_aware::turn_line_test
