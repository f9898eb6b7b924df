// What evaluate_fail_aware keeps of its runs (--keep-episodes), so that runs judged one by one can be judged together
// later (--episodes): the same figures, to the last digit, as over all the runs at once.
//
// Binary, numbers as they are in memory: read it on the kind of machine that wrote it. Of an episode's covariance since
// t1 the horizontal block is kept; what is not kept is NaN when it is read. About 200 bytes a sweep and episode.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "evaluation/fail_aware_episode.hpp"
#include "fail_aware_report.hpp"

namespace fail_aware {

/// One run after the replay of its monitor.
struct JudgedRun {
  std::string name;
  double alert_limit_m = 0.0;
  double episode_every_s = 0.0;
  ConsistencySamples samples;
  std::vector<FailAwareEpisode> episodes;
};

/// Throws std::runtime_error, InputError.
void writeEpisodeFile(const std::filesystem::path& path, const std::vector<JudgedRun>& runs);

/// Throws InputError: not such a file, of another version, not complete, or damaged (CRC-32).
std::vector<JudgedRun> readEpisodeFile(const std::filesystem::path& path);

}  // namespace fail_aware
