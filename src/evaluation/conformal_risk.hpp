// How often the time to failure is late on a drive that was not used to calibrate, with a guarantee: conformal risk
// control (Angelopoulos, Bates, Fisch, Lei, Schuster: "Conformal Risk Control", ICLR 2024).
//
// The unit is the drive, not the prediction: the predictions of one drive share its lidar and its roads. The loss of a
// drive is the ratio of late predictions among the judged ones of its failing episodes. If n drives have the mean
// loss L, and the confidence is the smallest at which (n L + 1) / (n + 1) is at most a given ratio, then the expected
// loss of a further drive is at most this ratio, too. This holds if
// - the further drive and the n drives come from the same population (lidar, roads, weather) and fail in that state;
//   nothing else was fitted to the n,
// - no fault begins between a prediction and the failure: predictions before a fault that was put into a drive do not
//   count,
// - at the largest confidence no drive is late more often than the ratio. A drive on which the odometry follows a wrong
//   motion and reports no doubt is late with every confidence, so there the guarantee does not hold,
// - no drive's loss rises with the confidence. A larger confidence gives shorter times, so it does not.
// Each state has its own losses: a guarantee over all states could be bought with the seconds in FAILING. The groups
// are the states that the monitor gave before the confidence was changed, so they do not depend on it.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "evaluation/fail_aware_calibration.hpp"
#include "evaluation/fail_aware_episode.hpp"

namespace fail_aware {

struct LateRisk {
  FailAwareState state = FailAwareState::kUnknown;
  std::size_t drives = 0;  ///< with judged predictions in this state
  double mean_loss = 0.0;  ///< over these drives
  /// (n L + 1) / (n + 1): must be at most the ratio that is to be guaranteed; 1 without drives.
  double criterion() const;
};

/// Of OK, DEGRADED and FAILING. `before`: the same episodes with the parameters that define the groups; throws
/// std::invalid_argument if they are not as many.
std::vector<LateRisk> lateRiskByState(const std::vector<FailAwareEpisode>& before,
                                      const std::vector<FailAwareEpisode>& episodes);

/// Drives without which no confidence can guarantee a late ratio.
std::size_t drivesToGuarantee(double late_ratio);

/// The smallest confidence, as in confidenceForLateRatio, for which the criterion of every state is at most
/// `late_ratio`.
std::optional<double> confidenceWithGuarantee(const std::vector<FailAwareEpisode>& before,
                                              const std::function<std::vector<FailAwareEpisode>(double)>& episodes_with,
                                              double late_ratio, double smallest = 0.5,
                                              double largest = kLargestConfidence);

}  // namespace fail_aware
