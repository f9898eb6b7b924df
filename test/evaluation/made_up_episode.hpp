// Episodes with a state a tenth of a second, written by hand, for the tests of the statistics.
#pragma once

#include <string>

#include "evaluation/fail_aware_episode.hpp"

namespace fail_aware {

/// One letter a sweep: U unknown, o OK, d DEGRADED, F FAILING, X FAILED. `fails_at`: that sweep is the failing one
/// (< 0: none; the run ends with the text).
inline FailAwareEpisode madeUpEpisode(const std::string& states, int fails_at, double speed_mps = 10.0) {
  FailAwareEpisode episode;
  episode.failed = fails_at >= 0;
  const int end = episode.failed ? fails_at : static_cast<int>(states.size()) - 1;
  episode.time_s = 0.1 * end;
  for (std::size_t i = 0; i < states.size(); ++i) {
    FailAwareSweep sweep;
    sweep.since_start_s = 0.1 * static_cast<double>(i);
    sweep.remaining_s = 0.1 * (end - static_cast<int>(i));
    sweep.speed_mps = speed_mps;
    switch (states[i]) {
      case 'o': sweep.output.state = FailAwareState::kOk; break;
      case 'd': sweep.output.state = FailAwareState::kDegraded; break;
      case 'F': sweep.output.state = FailAwareState::kFailing; break;
      case 'X': sweep.output.state = FailAwareState::kFailed; break;
      default: sweep.output.state = FailAwareState::kUnknown;
    }
    episode.sweeps.push_back(sweep);
  }
  return episode;
}

}  // namespace fail_aware
