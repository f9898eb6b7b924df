#include "evaluation/time_to_failure.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/io/input_error.hpp"
#include "core/parameters/check.hpp"
#include "trajectory_poses.hpp"

namespace fail_aware::time_to_failure_test {
namespace {

std::vector<double> tenHertz(std::size_t count) {
  std::vector<double> stamps_s;
  for (std::size_t i = 0; i < count; ++i) stamps_s.push_back(1.5e9 + 0.1 * static_cast<double>(i));
  return stamps_s;
}

struct Drive {
  std::vector<Pose> truth, estimate;
};

Drive sidewaysDrift(int count, double drift_m) {
  Drive run;
  for (int i = 0; i < count; ++i) {
    run.truth.push_back(at(i, 0.0));
    run.estimate.push_back(at(i, drift_m * i));
  }
  return run;
}

TEST(TimeToFailure, SteadyDriftByHand) {
  // 10.1 mm a step: 0.5959 m after 59 steps, 0.606 m after 60
  const Drive run = sidewaysDrift(201, 0.0101);
  const std::vector<FailureEpisode> episodes = failureEpisodes(run.truth, run.estimate, tenHertz(201));
  ASSERT_EQ(episodes.size(), 4u);  // at 0, 5, 10, 15 s; nothing follows the pose at 20 s
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(episodes[k].begin, 50 * k);
    EXPECT_NEAR(episodes[k].begin_s, 1.5e9 + 5.0 * static_cast<double>(k), 1e-6);
    EXPECT_EQ(episodes[k].failed, k < 3);
    EXPECT_EQ(episodes[k].end, k < 3 ? episodes[k].begin + 60 : 200);
    EXPECT_NEAR(episodes[k].time_s, k < 3 ? 6.0 : 5.0, 1e-6);
  }
  EXPECT_NEAR(medianTimeToFailure(episodes).value(), 6.0, 1e-6);
}

TEST(TimeToFailure, EpisodesBeginAsLongAsAPoseFollows) {
  const auto count = [](int poses) {
    const Drive run = sidewaysDrift(poses, 0.0);
    return failureEpisodes(run.truth, run.estimate, tenHertz(static_cast<std::size_t>(poses))).size();
  };
  EXPECT_EQ(count(2), 1u);
  EXPECT_EQ(count(51), 1u);
  EXPECT_EQ(count(52), 2u);
  EXPECT_EQ(count(271), 6u);
  EXPECT_EQ(count(600), 12u);
  EXPECT_EQ(count(1101), 22u);
}

TEST(TimeToFailure, ErrorEqualToTheLimitIsNotYetFailure) {
  const std::vector<Pose> truth = {at(0, 0), at(1, 0), at(2, 0)};
  const std::vector<Pose> estimate = {at(0, 0), at(1, 0.5), at(2, 0.75)};
  const FailureEpisode episode = failureEpisode(truth, estimate, {0.0, 1.0, 2.0}, 0, 0.5);
  EXPECT_TRUE(episode.failed);
  EXPECT_EQ(episode.time_s, 2.0);
}

TEST(TimeToFailure, FirstCrossingCountsEvenIfTheErrorGoesBack) {
  const std::vector<Pose> truth = {at(0, 0), at(1, 0), at(2, 0), at(3, 0)};
  const std::vector<Pose> estimate = {at(0, 0), at(1, 0.7), at(2, 0), at(3, 0)};
  const FailureEpisode episode = failureEpisode(truth, estimate, {0.0, 0.1, 0.2, 0.3}, 0, 0.6);
  EXPECT_TRUE(episode.failed);
  EXPECT_EQ(episode.end, 1u);
  // an episode that begins at the stray pose sees the way back as the error
  EXPECT_TRUE(failureEpisode(truth, estimate, {0.0, 0.1, 0.2, 0.3}, 1, 0.6).failed);
  EXPECT_FALSE(failureEpisode(truth, estimate, {0.0, 0.1, 0.2, 0.3}, 2, 0.6).failed);
}

TEST(TimeToFailure, ErrorIsRelativeToThePoseAtTheBegin) {
  const std::vector<Pose> truth = {at(0, 0), at(0, 1, 0, 1.0), at(0, 2, 0, 1.0)};
  std::vector<Pose> estimate;
  for (const Pose& T : truth) estimate.push_back(at(100, -50, 9, 2.0) * T);
  EXPECT_NEAR(horizontalError(truth, estimate, 0, 2), 0.0, 1e-9);
  EXPECT_NEAR(horizontalError(truth, estimate, 1, 2), 0.0, 1e-9);
}

TEST(TimeToFailure, HeadingErrorAtTheBeginIsAlignedAway) {
  // the estimate turns 0.1 rad too far at its second pose, then drives on correctly
  const std::vector<Pose> truth = {at(0, 0), at(1, 0), at(11, 0)};
  const std::vector<Pose> estimate = {at(0, 0), at(1, 0, 0, 0.1), at(1, 0, 0, 0.1) * at(10, 0)};
  EXPECT_NEAR(horizontalError(truth, estimate, 1, 2), 0.0, 1e-12);
  EXPECT_NEAR(horizontalError(truth, estimate, 0, 2), 20.0 * std::sin(0.05), 1e-12);
}

TEST(TimeToFailure, HeightDoesNotCount) {
  const std::vector<Pose> truth = {at(0, 0), at(1, 0)};
  const std::vector<Pose> estimate = {at(0, 0), at(1.3, 0.4, 5.0)};
  EXPECT_NEAR(horizontalError(truth, estimate, 0, 1), 0.5, 1e-12);
}

TEST(TimeToFailure, GapInTheStampsSkipsTheEpisodesInIt) {
  const Drive run = sidewaysDrift(6, 0.0);
  const std::vector<FailureEpisode> episodes =
      failureEpisodes(run.truth, run.estimate, {0.0, 1.0, 2.0, 12.0, 13.0, 16.0});
  ASSERT_EQ(episodes.size(), 2u);
  EXPECT_EQ(episodes[1].begin, 3u);
  EXPECT_EQ(episodes[1].time_s, 4.0);
  EXPECT_FALSE(episodes[1].failed);
}

TEST(TimeToFailure, MedianLeavesOutTheCensored) {
  const auto episode = [](double time_s, bool failed) {
    FailureEpisode e;
    e.time_s = time_s;
    e.failed = failed;
    return e;
  };
  EXPECT_EQ(medianTimeToFailure({episode(50.0, false)}), std::nullopt);
  EXPECT_EQ(medianTimeToFailure({episode(9.0, true), episode(1.0, true), episode(50.0, false), episode(4.0, true)}),
            4.0);
  EXPECT_EQ(medianTimeToFailure({episode(9.0, true), episode(4.0, true)}), 6.5);
}

TEST(TimeToFailure, UnusableInputIsRefused) {
  const Drive run = sidewaysDrift(3, 0.0);
  EXPECT_THROW(failureEpisodes(run.truth, run.estimate, {0.0, 0.1}), InputError);
  EXPECT_THROW(failureEpisodes(run.truth, run.estimate, {0.0, 0.2, 0.1}), InputError);
  EXPECT_THROW(failureEpisodes(run.truth, run.estimate, {0.0, NAN, 0.1}), InputError);
  EXPECT_THROW(failureEpisodes(run.truth, {run.truth[0]}, {0.0, 0.1, 0.2}), InputError);
  EXPECT_THROW(failureEpisodes(run.truth, run.estimate, {0.0, 0.1, 0.2}, {0.0, 5.0}), ParameterError);
  EXPECT_THROW(failureEpisodes(run.truth, run.estimate, {0.0, 0.1, 0.2}, {0.6, -1.0}), ParameterError);
}

}  // namespace
}  // namespace fail_aware::time_to_failure_test
