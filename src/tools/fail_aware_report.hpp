// The figures of evaluate_fail_aware over any set of episodes, as JSON and as a table.
#pragma once

#include <cstdint>
#include <ostream>
#include <vector>

#include "evaluation/fail_aware_episode.hpp"
#include "fail_aware_run.hpp"
#include "json.hpp"

namespace fail_aware {

struct ReportOptions {
  int resamples = 1000;
  std::uint64_t seed = 1;
  double early_s = 30.0;  ///< an alarm earlier than this before a failure is false
};

/// What is said about the time to failure; the predictors and baselines by name.
Json predictionReport(const std::vector<FailAwareEpisode>& episodes, const ReportOptions& options);

/// Covariances against true errors: increments, accumulated position, innovations.
Json consistencyReport(const std::vector<const FailAwareRun*>& runs, const std::vector<FailAwareEpisode>& episodes);

/// One column a report, in order of `json`'s keys.
void printTable(std::ostream& out, const Json& reports_by_name);

/// One row a second of every episode: what the plots are made of.
void writePredictions(std::ostream& out, const std::vector<FailAwareRun>& runs,
                      const std::vector<FailAwareEpisode>& episodes);

}  // namespace fail_aware
