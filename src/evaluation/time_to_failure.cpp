#include "evaluation/time_to_failure.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/io/input_error.hpp"
#include "core/parameters/check.hpp"
#include "core/stamp_difference.hpp"
#include "evaluation/trajectory_pair.hpp"

namespace fail_aware {

namespace {

void requireStamps(const std::vector<double>& stamps_s, std::size_t poses) {
  if (stamps_s.size() != poses) {
    throw InputError("there are " + std::to_string(poses) + " poses and " + std::to_string(stamps_s.size()) +
                     " stamps: they must be equally many");
  }
  for (std::size_t i = 0; i < stamps_s.size(); ++i) {
    if (!std::isfinite(stamps_s[i]) || (i > 0 && stamps_s[i] < stamps_s[i - 1])) {
      throw InputError("stamp " + std::to_string(i) + " is not finite or goes back");
    }
  }
}

}  // namespace

void FailureEpisode::Params::validate() const {
  requirePositive("alert_limit_m", alert_limit_m);
  requirePositive("episode_every_s", episode_every_s);
}

double horizontalError(const std::vector<Pose>& truth, const std::vector<Pose>& estimate, std::size_t begin,
                       std::size_t at) {
  const Eigen::Vector3d true_position = truth[begin].inverse() * truth[at].translation();
  const Eigen::Vector3d estimated_position = estimate[begin].inverse() * estimate[at].translation();
  return (estimated_position - true_position).head<2>().norm();
}

FailureEpisode failureEpisode(const std::vector<Pose>& truth, const std::vector<Pose>& estimate,
                              const std::vector<double>& stamps_s, std::size_t begin, double alert_limit_m) {
  FailureEpisode episode;
  episode.begin = begin;
  episode.begin_s = stamps_s[begin];
  episode.end = begin;
  while (!episode.failed && episode.end + 1 < truth.size()) {
    ++episode.end;
    episode.failed = horizontalError(truth, estimate, begin, episode.end) > alert_limit_m;
  }
  episode.time_s = stamps_s[episode.end] - episode.begin_s;
  return episode;
}

std::vector<FailureEpisode> failureEpisodes(const std::vector<Pose>& truth, const std::vector<Pose>& estimate,
                                            const std::vector<double>& stamps_s, const FailureEpisode::Params& params) {
  params.validate();
  requirePosePairs(truth, estimate);
  requireStamps(stamps_s, truth.size());

  std::vector<FailureEpisode> episodes;
  double periods = 0.0;  // of the next episode's nominal begin
  for (std::size_t i = 0; i + 1 < stamps_s.size(); ++i) {
    const double elapsed_s = stamps_s[i] - stamps_s.front() + kStampTolerance_s;
    if (elapsed_s < periods * params.episode_every_s) continue;
    episodes.push_back(failureEpisode(truth, estimate, stamps_s, i, params.alert_limit_m));
    periods = std::floor(elapsed_s / params.episode_every_s) + 1.0;
  }
  return episodes;
}

std::optional<double> medianTimeToFailure(const std::vector<FailureEpisode>& episodes) {
  std::vector<double> times_s;
  for (const FailureEpisode& episode : episodes) {
    if (episode.failed) times_s.push_back(episode.time_s);
  }
  if (times_s.empty()) return std::nullopt;
  std::sort(times_s.begin(), times_s.end());
  const std::size_t middle = times_s.size() / 2;
  return times_s.size() % 2 == 1 ? times_s[middle] : 0.5 * (times_s[middle - 1] + times_s[middle]);
}

}  // namespace fail_aware
