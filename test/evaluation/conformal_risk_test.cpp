#include "evaluation/conformal_risk.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "made_up_episode.hpp"

namespace fail_aware::conformal_risk_test {
namespace {

/// Judged 1 s after t1 only, in the given state, `remaining_s` before the failure; the time that a confidence gives is
/// 10 (1 - confidence).
FailAwareEpisode judgedOnce(std::size_t run, char state, double remaining_s, double confidence) {
  FailAwareEpisode episode = madeUpEpisode(std::string(11, state), 10);
  episode.run = run;
  episode.sweeps[10].remaining_s = remaining_s;
  episode.sweeps[10].output.time_to_failure_covariance = TimeToFailure::fromSeconds(10.0 * (1.0 - confidence), 60.0);
  episode.sweeps.push_back(episode.sweeps[10]);
  episode.sweeps.back().remaining_s = 0.0;  // the failing one
  return episode;
}

/// One drive in each state for each remaining time.
std::vector<FailAwareEpisode> drivesWith(const std::vector<double>& remaining_s, double confidence,
                                         const std::string& states = "odF") {
  std::vector<FailAwareEpisode> episodes;
  for (std::size_t run = 0; run < remaining_s.size(); ++run) {
    for (const char state : states) episodes.push_back(judgedOnce(run, state, remaining_s[run], confidence));
  }
  return episodes;
}

std::vector<double> drawn(std::size_t drives, std::mt19937& generator) {
  std::uniform_real_distribution<double> uniform(0.1, 4.9);
  std::vector<double> remaining_s(drives);
  for (double& r : remaining_s) r = uniform(generator);
  return remaining_s;
}

TEST(ConformalRisk, LossIsTheMeanOverDrivesNotPredictions) {
  std::vector<FailAwareEpisode> episodes = drivesWith({5.0, 1.0}, 0.8, "o");  // 2 s are predicted
  for (int k = 0; k < 8; ++k) episodes.push_back(judgedOnce(0, 'o', 5.0, 0.8));
  const std::vector<LateRisk> risks = lateRiskByState(episodes, episodes);
  ASSERT_EQ(risks.size(), 3u);
  EXPECT_EQ(risks[0].state, FailAwareState::kOk);
  EXPECT_EQ(risks[0].drives, 2u);
  EXPECT_DOUBLE_EQ(risks[0].mean_loss, 0.5);
  EXPECT_DOUBLE_EQ(risks[0].criterion(), 2.0 / 3.0);
  EXPECT_EQ(risks[1].drives, 0u);
  EXPECT_DOUBLE_EQ(risks[1].criterion(), 1.0);
}

TEST(ConformalRisk, SoundEpisodesDoNotCount) {
  std::vector<FailAwareEpisode> episodes = drivesWith({5.0, 1.0}, 0.8, "o");
  episodes[1].failed = false;
  EXPECT_EQ(lateRiskByState(episodes, episodes)[0].drives, 1u);
}

TEST(ConformalRisk, PredictionsBeforeAFaultDoNotCount) {
  std::vector<FailAwareEpisode> episodes = drivesWith({5.0, 1.0}, 0.8, "o");
  episodes[1].time_s = 2.0;
  episodes[1].fault_begins_s = {0.5};  // before the prediction
  EXPECT_EQ(lateRiskByState(episodes, episodes)[0].drives, 2u);
  episodes[1].fault_begins_s = {1.5};
  EXPECT_EQ(lateRiskByState(episodes, episodes)[0].drives, 1u);
  episodes[1].fault_begins_s = {2.5};  // after the failure
  EXPECT_EQ(lateRiskByState(episodes, episodes)[0].drives, 2u);
}

TEST(ConformalRisk, GroupsAreTheStatesBeforeTheChange) {
  const std::vector<FailAwareEpisode> before = drivesWith({1.0}, 0.8, "d");
  const std::vector<LateRisk> risks = lateRiskByState(before, drivesWith({1.0}, 0.8, "F"));
  EXPECT_EQ(risks[1].drives, 1u);
  EXPECT_EQ(risks[2].drives, 0u);
}

TEST(ConformalRisk, OtherEpisodesAreRefused) {
  EXPECT_THROW(lateRiskByState(drivesWith({5.0}, 0.8), drivesWith({5.0, 1.0}, 0.8)), std::invalid_argument);
}

TEST(ConformalRisk, TooFewDrivesGuaranteeNothing) {
  EXPECT_EQ(drivesToGuarantee(0.1), 9u);
  EXPECT_EQ(drivesToGuarantee(0.3), 3u);
  EXPECT_EQ(drivesToGuarantee(1.0), 0u);
  const auto fitted = [](std::size_t drives, const std::string& states) {
    const std::vector<double> remaining_s(drives, 4.0);
    return confidenceWithGuarantee(
        drivesWith(remaining_s, 0.99, states),
        [&](double confidence) { return drivesWith(remaining_s, confidence, states); }, 0.1);
  };
  EXPECT_FALSE(fitted(8, "odF"));
  EXPECT_TRUE(fitted(9, "odF"));
  EXPECT_FALSE(fitted(9, "od")) << "nothing is known of FAILING";
}

TEST(ConformalRisk, HoldsOnFurtherDrivesWhereTheRatioDoesNot) {
  // With 18 drives the plain ratio allows one late drive, the guarantee none. So 2 of 19 and 1 of 19 further drives are
  // late.
  std::mt19937 generator(7);
  constexpr int kTrials = 400;
  constexpr double kLate = 0.1;
  double with_guarantee = 0.0, with_ratio = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const std::vector<double> seen_s = drawn(18, generator), further_s = drawn(50, generator);
    const auto episodesWith = [&](double confidence) { return drivesWith(seen_s, confidence); };
    const auto loss = [&](double confidence) {
      const std::vector<FailAwareEpisode> further = drivesWith(further_s, confidence);
      return lateRiskByState(further, further).front().mean_loss;
    };
    with_guarantee += loss(confidenceWithGuarantee(episodesWith(0.99), episodesWith, kLate).value());
    with_ratio += loss(confidenceForLateRatio(episodesWith, kLate).value());
  }
  EXPECT_NEAR(with_guarantee / kTrials, 1.0 / 19.0, 0.01);
  EXPECT_NEAR(with_ratio / kTrials, 2.0 / 19.0, 0.012);
}

}  // namespace
}  // namespace fail_aware::conformal_risk_test
