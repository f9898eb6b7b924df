#include "evaluation/prediction_statistics.hpp"

#include <gtest/gtest.h>

namespace fail_aware::prediction_statistics_test {
namespace {

TimeToFailure seconds(double s) { return TimeToFailure::fromSeconds(s, 60.0); }

TEST(PredictionStatistics, LateIsLongerThanTheTruth) {
  const LateStatistics s = lateStatistics({{1.0, 10.0, true, seconds(9.0)},
                                           {1.0, 10.0, true, seconds(10.0)},
                                           {1.0, 10.0, true, seconds(11.0)},
                                           {1.0, 10.0, true, seconds(1e9)},
                                           {1.0, 70.0, true, seconds(1e9)},  // beyond the horizon, and it was
                                           {1.0, 10.0, true, TimeToFailure::unknown()}});
  EXPECT_EQ(s.decided, 5u);
  EXPECT_EQ(s.late, 2u);
  EXPECT_DOUBLE_EQ(s.lateRatio(), 0.4);
}

TEST(PredictionStatistics, NoFailureDecidesShorterPredictionsOnly) {
  const LateStatistics s = lateStatistics(
      {{1.0, 10.0, false, seconds(9.0)}, {1.0, 10.0, false, seconds(11.0)}, {1.0, 10.0, true, seconds(11.0)}});
  EXPECT_EQ(s.decided, 2u);
  EXPECT_EQ(s.failing_decided, 1u);
  EXPECT_DOUBLE_EQ(s.lateRatio(), 0.5);
  EXPECT_DOUBLE_EQ(s.lateRatioOfFailing(), 1.0);
  EXPECT_EQ(lateStatistics({}).lateRatio(), 0.0);
}

TEST(PredictionStatistics, ACountdownIsSteady) {
  std::vector<JudgedPrediction> episode;
  for (int k = 0; k <= 30; ++k) episode.push_back({static_cast<double>(k), 30.0 - k, true, seconds(25.0 - k)});
  const StabilityStatistics s = stabilityOf(episode);
  EXPECT_EQ(s.steps, 30u);
  EXPECT_EQ(s.jumps, 0u);
  EXPECT_EQ(s.sign_changes, 0u);
  EXPECT_DOUBLE_EQ(s.watched_s, 30.0);
}

TEST(PredictionStatistics, JumpsAndSignChangesByHand) {
  // expected 19, 9, 14, 9.5: deviations -9 (47 %), +6 (67 %), -3.5 (25 %), -0.5
  const StabilityStatistics s = stabilityOf({{0.0, 99.0, true, seconds(20.0)},
                                             {1.0, 98.0, true, seconds(10.0)},
                                             {2.0, 97.0, true, seconds(15.0)},
                                             {3.0, 96.0, true, seconds(10.5)},
                                             {4.0, 95.0, true, seconds(9.0)}});
  EXPECT_EQ(s.steps, 4u);
  EXPECT_EQ(s.changes, 0u) << "10 of 20 are half";
  EXPECT_EQ(s.jumps, 1u);
  EXPECT_EQ(s.sign_changes, 2u);
  EXPECT_DOUBLE_EQ(s.signChangesPerMinute(), 30.0);
  EXPECT_DOUBLE_EQ(s.jumpRatio(), 0.25);
  EXPECT_DOUBLE_EQ((s + s).jumpRatio(), 0.25);
  EXPECT_EQ((s + s).steps, 8u);
}

TEST(PredictionStatistics, ChangeIsOfTheLastPrediction) {
  const StabilityStatistics s = stabilityOf({{0.0, 99.0, true, seconds(20.0)},
                                             {1.0, 98.0, true, seconds(9.0)},
                                             {2.0, 97.0, true, seconds(14.0)},
                                             {3.0, 96.0, true, seconds(0.0)},
                                             {4.0, 95.0, true, seconds(0.0)}});
  EXPECT_EQ(s.changes, 3u);
  EXPECT_DOUBLE_EQ(s.changeRatio(), 0.75);
  EXPECT_DOUBLE_EQ((s + s).changeRatio(), 0.75);
}

TEST(PredictionStatistics, BeyondTheHorizonStaysThere) {
  const StabilityStatistics s = stabilityOf({{0.0, 99.0, true, seconds(1e9)},
                                             {1.0, 98.0, true, seconds(1e9)},
                                             {2.0, 97.0, true, TimeToFailure::unknown()},
                                             {3.0, 96.0, true, seconds(5.0)}});
  EXPECT_EQ(s.steps, 1u);
  EXPECT_EQ(s.jumps, 0u);
  EXPECT_DOUBLE_EQ(s.watched_s, 3.0);
}

TEST(PredictionStatistics, ReliabilityByHand) {
  const std::vector<JudgedPrediction> predictions = {{1.0, 3.0, true, seconds(4.0)},   // failed within
                                                     {1.0, 8.0, true, seconds(4.0)},   // did not
                                                     {1.0, 9.0, false, seconds(4.0)},  // did not
                                                     {1.0, 2.0, false, seconds(4.0)},  // not known
                                                     {1.0, 30.0, true, seconds(1e9)},  // last bin: failed within
                                                     {1.0, 1.0, true, TimeToFailure::unknown()}};
  const std::vector<ReliabilityBin> bins = reliabilityCurve(predictions, {0.0, 5.0, 60.0});
  ASSERT_EQ(bins.size(), 2u);
  EXPECT_EQ(bins[0].predictions, 4u);
  EXPECT_EQ(bins[0].decided, 3u);
  EXPECT_EQ(bins[0].failed_within, 1u);
  EXPECT_DOUBLE_EQ(bins[0].median_remaining_s, 8.0);
  EXPECT_EQ(bins[1].predictions, 1u);
  EXPECT_EQ(bins[1].failed_within, 1u);
}

}  // namespace
}  // namespace fail_aware::prediction_statistics_test
