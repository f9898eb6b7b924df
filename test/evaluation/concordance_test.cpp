#include "evaluation/concordance.hpp"

#include <gtest/gtest.h>

namespace fail_aware::concordance_test {
namespace {

using Predicted = std::vector<std::optional<double>>;

const std::vector<SurvivalSample> kFourFailures = {{1.0, true, 0}, {2.0, true, 1}, {3.0, true, 2}, {4.0, true, 3}};

TEST(Concordance, PerfectReversedAndConstant) {
  EXPECT_DOUBLE_EQ(Concordance(kFourFailures, Predicted{10.0, 20.0, 30.0, 40.0}).all().index().value(), 1.0);
  EXPECT_DOUBLE_EQ(Concordance(kFourFailures, Predicted{4.0, 3.0, 2.0, 1.0}).all().index().value(), 0.0);
  EXPECT_DOUBLE_EQ(Concordance(kFourFailures, Predicted{7.0, 7.0, 7.0, 7.0}).all().index().value(), 0.5);
  EXPECT_DOUBLE_EQ(Concordance(kFourFailures, Predicted(4)).all().index().value(), 0.5) << "unknown";
}

TEST(Concordance, OneSwapOfSixPairs) {
  const ConcordancePairs pairs = Concordance(kFourFailures, Predicted{2.0, 1.0, 3.0, 4.0}).all();
  EXPECT_DOUBLE_EQ(pairs.comparable, 6.0);
  EXPECT_DOUBLE_EQ(pairs.score, 5.0);
}

TEST(Concordance, CensoredComparesWithEarlierFailures) {
  // failed at 2, watched to 1, watched to 5: only (2, 5) is known
  const std::vector<SurvivalSample> samples = {{2.0, true, 0}, {1.0, false, 1}, {5.0, false, 2}};
  const ConcordancePairs pairs = Concordance(samples, Predicted{2.0, 99.0, 3.0}).all();
  EXPECT_DOUBLE_EQ(pairs.comparable, 1.0);
  EXPECT_DOUBLE_EQ(pairs.score, 1.0);
  EXPECT_FALSE(Concordance({{1.0, false, 0}, {2.0, false, 1}}, Predicted{1.0, 2.0}).all().index());
}

TEST(Concordance, OfEqualTimesTheFailureIsTheSooner) {
  const std::vector<SurvivalSample> samples = {{2.0, true, 0}, {2.0, false, 1}, {2.0, true, 2}};
  const ConcordancePairs pairs = Concordance(samples, Predicted{1.0, 2.0, 3.0}).all();
  EXPECT_DOUBLE_EQ(pairs.comparable, 2.0);
  EXPECT_DOUBLE_EQ(pairs.score, 1.0);
}

TEST(Concordance, AnUnknownPredictionScoresHalf) {
  const ConcordancePairs pairs = Concordance(kFourFailures, Predicted{1.0, std::nullopt, 3.0, 4.0}).all();
  EXPECT_DOUBLE_EQ(pairs.score, 3.0 + 3.0 * 0.5);
}

TEST(Concordance, BetweenGroupsAClockIsNoHelp) {
  // two episodes of equal length: inside each the clock is right, between them it says nothing
  std::vector<SurvivalSample> samples;
  Predicted clock;
  for (std::size_t episode = 0; episode < 2; ++episode) {
    for (int k = 0; k < 10; ++k) {
      samples.push_back({10.0 - k, true, episode});
      clock.push_back(-k - 0.5 * static_cast<double>(episode));
    }
  }
  const Concordance concordance(samples, clock);
  EXPECT_DOUBLE_EQ(concordance.betweenGroups().comparable, 90.0);
  EXPECT_DOUBLE_EQ(concordance.betweenGroups().index().value(), 1.0) << "here it is as good as the other";
  EXPECT_DOUBLE_EQ(concordance.all().comparable, 180.0);
}

TEST(Concordance, TheIntervalIsRepeatableAndHoldsTheIndex) {
  std::vector<SurvivalSample> samples;
  Predicted predicted;
  for (std::size_t i = 0; i < 60; ++i) {
    samples.push_back({static_cast<double>((i * 37) % 60), i % 4 != 0, i});
    predicted.push_back(samples.back().time_s + 25.0 * static_cast<double>((i * 17) % 7 % 3));
  }
  const Concordance concordance(samples, predicted);
  const double index = concordance.all().index().value();
  const Interval interval = concordance.interval(500, 0.95, 1).value();
  EXPECT_LT(interval.low, index);
  EXPECT_GT(interval.high, index);
  EXPECT_GT(interval.high - interval.low, 0.02);
  EXPECT_LT(interval.high - interval.low, 0.3);
  const Interval again = concordance.interval(500, 0.95, 1).value(), other = concordance.interval(500, 0.95, 2).value();
  EXPECT_EQ(interval.low, again.low);
  EXPECT_EQ(interval.high, again.high);
  EXPECT_NE(interval.low, other.low);
}

TEST(Concordance, OneGroupHasNoSpread) {
  std::vector<SurvivalSample> samples = kFourFailures;
  for (SurvivalSample& sample : samples) sample.group = 0;
  const Interval interval = Concordance(samples, Predicted{2.0, 1.0, 3.0, 4.0}).interval(20, 0.9, 3).value();
  EXPECT_DOUBLE_EQ(interval.low, 5.0 / 6.0);
  EXPECT_DOUBLE_EQ(interval.high, 5.0 / 6.0);
  EXPECT_FALSE(Concordance({}, {}).interval(20, 0.9, 3));
}

}  // namespace
}  // namespace fail_aware::concordance_test
