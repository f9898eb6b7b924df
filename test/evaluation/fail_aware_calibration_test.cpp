#include "evaluation/fail_aware_calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/integrity/covariance_predictor.hpp"
#include "made_up_episode.hpp"

namespace fail_aware::fail_aware_calibration_test {
namespace {

/// Eta grows by 1e-5 a sweep.
FailAwareEpisode withEta(int sweeps, int fails_at) {
  FailAwareEpisode episode = madeUpEpisode(std::string(static_cast<std::size_t>(sweeps), 'o'), fails_at);
  for (std::size_t i = 0; i < episode.sweeps.size(); ++i) episode.sweeps[i].output.eta = 1e-5 * static_cast<double>(i);
  return episode;
}

TEST(FailAwareCalibration, EtaThresholdIsTheQuantileOfFailures) {
  const std::vector<FailAwareEpisode> episodes = {withEta(100, 20), withEta(100, 40), withEta(100, 60),
                                                  withEta(100, 80)};
  EXPECT_NEAR(etaThreshold(episodes, 0.25).value(), 20e-5, 1e-12);
  EXPECT_NEAR(etaThreshold(episodes, 0.5).value(), 40e-5, 1e-12);
  EXPECT_NEAR(etaThreshold(episodes, 0.51).value(), 60e-5, 1e-12);
}

TEST(FailAwareCalibration, NoFailureIsCensored) {
  const std::vector<FailAwareEpisode> episodes = {withEta(100, 20), withEta(31, -1), withEta(100, 60),
                                                  withEta(100, -1)};
  // 1/4 failed at 20, of the two left after 30 one at 60: 1 - 3/4 * 1/2
  EXPECT_NEAR(etaThreshold(episodes, 0.3).value(), 60e-5, 1e-12);
  EXPECT_NEAR(etaThreshold(episodes, 0.625).value(), 60e-5, 1e-12);
  EXPECT_FALSE(etaThreshold(episodes, 0.7));
  EXPECT_FALSE(etaThreshold({}, 0.1));
  EXPECT_FALSE(etaThreshold({withEta(100, 0), withEta(100, 50)}, 0.1)) << "a failure before eta grows gives none";
}

TEST(FailAwareCalibration, QuietThresholdHasFewFalseAlarms) {
  std::vector<FailAwareEpisode> episodes = {withEta(100, 2)};
  for (int k = 1; k <= 11; ++k) episodes.push_back(withEta(10 * k, -1));  // eta at the end: 9, 19, .. 109
  EXPECT_NEAR(quietEtaThreshold(episodes, 0.1).value(), 99e-5, 1e-12);
  EXPECT_NEAR(quietEtaThreshold(episodes, 0.0).value(), 109e-5, 1e-12);
  EXPECT_FALSE(quietEtaThreshold({withEta(100, 2)}, 0.1));
}

TEST(FailAwareCalibration, TheLargestAlarmConfidenceThatIsSeldomUp) {
  // the alarm is up from sweep 100 (1 - confidence) on; of 100 sweeps without a failure
  const auto episodes_with = [](double confidence) {
    std::vector<FailAwareEpisode> episodes = {madeUpEpisode("XXXXXXXXXXXXXXXX", 12),
                                              madeUpEpisode(std::string(101, 'o'), -1)};
    for (std::size_t i = 0; i <= 100; ++i) {
      if (static_cast<double>(i) >= 100.0 * (1.0 - confidence)) {
        episodes[1].sweeps[i].output.state = FailAwareState::kFailed;
      }
    }
    return episodes;
  };
  EXPECT_NEAR(confidenceForAlarmRatio(episodes_with, 0.2, 0.05, 0.95).value(), 0.2, 0.011);
  EXPECT_EQ(confidenceForAlarmRatio(episodes_with, 1.0, 0.05, 0.95).value(), 0.95);
  EXPECT_FALSE(confidenceForAlarmRatio(episodes_with, 0.0, 0.05, 0.95));
  const auto failing = [](double) { return std::vector<FailAwareEpisode>{madeUpEpisode("XXXXXXXXXXXXXXXX", 12)}; };
  EXPECT_FALSE(confidenceForAlarmRatio(failing, 0.2, 0.05, 0.95)) << "no time without a failure to judge by";
}

TEST(FailAwareCalibration, TheSmallestConfidenceThatIsSeldomLate) {
  // ten episodes that fail after 1, 2, .. 10 s; the prediction at 1 s is 10 s less the confidence's worth
  const auto episodes_with = [](double confidence) {
    std::vector<FailAwareEpisode> episodes;
    for (int k = 1; k <= 10; ++k) {
      FailAwareEpisode episode = madeUpEpisode(std::string(200, 'o'), 10 + 10 * k);
      episode.sweeps.resize(11);  // judged at 1 s only, k s before the failure
      episode.sweeps[10].output.time_to_failure_covariance =
          TimeToFailure::fromSeconds(10.4 * (1.0 - confidence), 60.0);
      episodes.push_back(episode);
    }
    return episodes;
  };
  // late at most once: the prediction must be at most 2 s
  const double confidence = confidenceForLateRatio(episodes_with, 0.1).value();
  EXPECT_NEAR(confidence, 1.0 - 2.0 / 10.4, 0.0035);
  EXPECT_LE(10.4 * (1.0 - confidence), 2.0);
  EXPECT_EQ(confidenceForLateRatio(episodes_with, 1.0).value(), 0.5);
  EXPECT_FALSE(confidenceForLateRatio(episodes_with, 0.1, 0.5, 0.6));
}

TEST(FailAwareCalibration, PredictionsBeforeAFaultDoNotCount) {
  const auto episodesWith = [](double fault_s) {
    return [fault_s](double confidence) {  // right from 0.9 on
      FailAwareEpisode episode = madeUpEpisode(std::string(200, 'o'), 30);
      episode.sweeps.resize(11);
      episode.fault_begins_s = {fault_s};
      episode.sweeps[10].output.time_to_failure_covariance =
          TimeToFailure::fromSeconds(20.0 * (1.0 - confidence), 60.0);
      return std::vector<FailAwareEpisode>{episode};
    };
  };
  EXPECT_NEAR(confidenceForLateRatio(episodesWith(0.5), 0.0).value(), 0.9, 0.003);
  EXPECT_FALSE(confidenceForLateRatio(episodesWith(1.5), 0.0)) << "nothing else is judged";
}

TEST(FailAwareCalibration, AConfidenceNearOneIsFoundAsWell) {
  const auto episodes_with = [](double confidence) {  // right from 0.9999 on
    FailAwareEpisode episode = madeUpEpisode(std::string(200, 'o'), 30);
    episode.sweeps.resize(11);
    episode.sweeps[10].output.time_to_failure_covariance =
        TimeToFailure::fromSeconds(10.0 + 2.0 * std::log10(1.0 - confidence), 60.0);
    return std::vector<FailAwareEpisode>{episode};
  };
  EXPECT_NEAR(1.0 - confidenceForLateRatio(episodes_with, 0.0).value(), 1e-4, 2.1e-6);
  EXPECT_LT(CovariancePredictor::Params().confidence, kLargestConfidence) << "what is shipped can be found";
}

}  // namespace
}  // namespace fail_aware::fail_aware_calibration_test
