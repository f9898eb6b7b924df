// The thresholds of the times to failure, from recorded episodes with truth.
//
// Eta's threshold, by either of two rules: the value of eta by which a share of the episodes has failed (passed the
// alert limit), those that never failed counted as far as they were watched (Kaplan and Meier): the article's meaning;
// or the value that all but a share of the episodes that never failed stay below: where eta says little of the error,
// at least it does not cry wolf.
// The predictor's confidence: the smallest at which at most `late_ratio` of the judged predictions of the covariance's
// time come late. 1 - confidence is that share where the covariance is true. Predictions before a fault that was put
// into the drive do not count.
// Its alarm confidence: the largest at which the alarm is up at most `alarm_ratio` of the time of episodes that never
// fail.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "evaluation/fail_aware_episode.hpp"

namespace fail_aware {

/// Nothing if fewer than that share failed within what was watched.
std::optional<double> etaThreshold(const std::vector<FailAwareEpisode>& episodes, double failed_by);

/// Nothing without episodes that did not fail, or if eta did not grow in them.
std::optional<double> quietEtaThreshold(const std::vector<FailAwareEpisode>& episodes, double passed_by);

constexpr double kLargestConfidence = 0.999999;  ///< that is tried, and that can be set in flight

/// Of the starts that fail those with a prediction that no later fault spoils.
std::size_t failuresThatCount(const std::vector<FailAwareEpisode>& episodes);

/// The smallest confidence at which `holds`, which must hold at every larger one, too. Found between the limits by
/// bisection of ln(c / (1 - c)), to 0.02: near 1, to 2 % of what is missing to 1. Nothing if it does not hold at the
/// largest.
std::optional<double> smallestConfidence(const std::function<bool(double)>& holds, double smallest, double largest);

/// `episodes_with(confidence)`: the episodes replayed with that confidence. Nothing if even the largest is late too
/// often, or if no episode fails: then none can be late.
std::optional<double> confidenceForLateRatio(const std::function<std::vector<FailAwareEpisode>(double)>& episodes_with,
                                             double late_ratio, double smallest = 0.5,
                                             double largest = kLargestConfidence);

/// Likewise with the alarm confidence; nothing if even the smallest is up too long.
std::optional<double> confidenceForAlarmRatio(const std::function<std::vector<FailAwareEpisode>(double)>& episodes_with,
                                              double alarm_ratio, double smallest, double largest);

}  // namespace fail_aware
