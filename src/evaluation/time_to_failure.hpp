// The true time to failure, against which predictions are judged (section "Fail-Aware Odometry System").
//
// An episode begins at t1, when the odometry starts to serve as the localisation; it fails at the first pose whose
// horizontal error relative to the pose at t1 exceeds the alert limit (equal is not yet failed). Horizontal error:
// truth and estimate, each expressed in its own frame at t1 (heading aligned there), compared in x and y. If the run
// ends before, the episode is right-censored: `failed` is false and `time_s` is a lower bound.
//
// Poses in pairs, in a moving frame with z up; stamps in s, one a pose, not decreasing (else InputError). Episodes
// begin at the first pose, and then at the first pose at or after every further `episode_every_s`, if a pose follows
// it. Cost: O(episodes x poses).
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/geometry/pose.hpp"

namespace fail_aware {

struct FailureEpisode {
  struct Params {
    double alert_limit_m = 0.6;
    double episode_every_s = 5.0;
    void validate() const;
  };

  std::size_t begin = 0;  ///< index of the pose at t1
  std::size_t end = 0;    ///< index of the pose that failed, or of the last one
  double begin_s = 0.0;   ///< stamp of t1
  double time_s = 0.0;    ///< from t1 to `end`
  bool failed = false;
};

/// The horizontal error (m) at pose `at` relative to pose `begin`.
double horizontalError(const std::vector<Pose>& truth, const std::vector<Pose>& estimate, std::size_t begin,
                       std::size_t at);

/// The episode that begins at one given pose (not the last).
FailureEpisode failureEpisode(const std::vector<Pose>& truth, const std::vector<Pose>& estimate,
                              const std::vector<double>& stamps_s, std::size_t begin, double alert_limit_m);

std::vector<FailureEpisode> failureEpisodes(const std::vector<Pose>& truth, const std::vector<Pose>& estimate,
                                            const std::vector<double>& stamps_s,
                                            const FailureEpisode::Params& params = {});

/// Median time of those that failed; none if none did.
std::optional<double> medianTimeToFailure(const std::vector<FailureEpisode>& episodes);

}  // namespace fail_aware
