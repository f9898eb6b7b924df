// Does a predictor put the sooner failure first? Harrell's concordance index for right-censored times.
//
// A pair of samples is comparable if it is known which fails sooner: the shorter time ended in a failure; of equal
// times, exactly one did. It scores 1 if the predictor gives the sooner failure the smaller value, 1/2 if it gives both
// the same or says nothing of one of them, else 0. Index = mean score; 1/2 is what a constant gets.
// Samples come in groups (episodes, or sequences) that are not independent inside; the interval comes from resampling
// whole groups with replacement, two copies of a group counting as two groups.
// Cost: O(samples^2) once, O(groups^2) a resample.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace fail_aware {

struct SurvivalSample {
  double time_s = 0.0;  ///< to the failure, or, if there was none, as far as it was watched
  bool failed = false;
  std::size_t group = 0;
};

struct ConcordancePairs {
  double score = 0.0;
  double comparable = 0.0;
  /// Nothing without a comparable pair.
  std::optional<double> index() const;
};

struct Interval {
  double low = 0.0, high = 0.0;
};

class Concordance {
 public:
  /// `predicted[i]` belongs to `samples[i]`: larger means later; nothing: unknown. Only its order counts.
  Concordance(const std::vector<SurvivalSample>& samples, const std::vector<std::optional<double>>& predicted);

  ConcordancePairs all() const;
  /// Only pairs of two groups: there the passing of time, which any clock knows, is no help.
  ConcordancePairs betweenGroups() const;

  /// Of all()'s index, by percentiles; nothing if no resample had a comparable pair.
  std::optional<Interval> interval(int resamples, double level, std::uint64_t seed) const;

 private:
  std::size_t groups_ = 0;
  std::vector<ConcordancePairs> table_;  ///< groups x groups, the smaller number first
};

}  // namespace fail_aware
