// The figures of evaluate_fail_aware over any set of episodes, as JSON and as a table.
#pragma once

#include <array>
#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "evaluation/fail_aware_episode.hpp"
#include "fail_aware_run.hpp"
#include "json.hpp"

namespace fail_aware {

struct ReportOptions {
  int resamples = 1000;
  std::uint64_t seed = 1;
  double early_s = 30.0;           ///< an alarm earlier than this before a failure is false
  double deceleration_mps2 = 2.0;  ///< of the planner's stop
};

/// What is said about the time to failure; the predictors and baselines by name.
Json predictionReport(const std::vector<FailAwareEpisode>& episodes, const ReportOptions& options);

/// The planner's figure (evaluation/planner_figure.hpp) with its baselines.
Json plannerReport(const std::vector<FailAwareEpisode>& episodes, const ReportOptions& options);

/// Squared errors of one run, sweep by sweep, in units of their standard deviations.
struct ConsistencySamples {
  using PerSource = std::array<std::vector<double>, 3>;  ///< the whole poses of kBuiltInSources
  std::vector<double> increments, horizontal_increments;
  PerSource innovations;  ///< NIS of each measurement
  PerSource measured;     ///< what each measurement said of the motion since the last estimate, against the truth
};

ConsistencySamples consistencySamples(const FailAwareRun& run);

/// Covariances against true errors: increments, accumulated position, innovations. The samples run by run.
Json consistencyReport(const std::vector<const ConsistencySamples*>& runs,
                       const std::vector<FailAwareEpisode>& episodes);

/// One row a second of every episode: what the plots are made of. `run_names[i]`: of the run that the episodes call i.
void writePredictions(std::ostream& out, const std::vector<std::string>& run_names,
                      const std::vector<FailAwareEpisode>& episodes);

/// One row an episode: what evaluation/alarm_statistics.hpp counts in it.
void writeEpisodes(std::ostream& out, const std::vector<std::string>& run_names,
                   const std::vector<FailAwareEpisode>& episodes, double early_s);

}  // namespace fail_aware
