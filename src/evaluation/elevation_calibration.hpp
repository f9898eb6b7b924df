// The error that the beams' elevations have in common, from several drives with one lidar: no ground truth. Not in the
// paper.
//
// The vertical reference (core/preprocessing/vertical_reference.hpp) finds the error in each drive anew, in the first
// 50 to 200 m, and until then pitch drifts. A drive that begins with the error of the last ones does not. The mean of
// the drives is weighted by 1 / sigma^2. Where they differ by more than their sigmas say, the sigma grows by that
// ratio.
//
// deg. Cost: negligible.
#pragma once

#include <optional>
#include <vector>

namespace fail_aware {

/// The beams that meet walls have errors of their own (0.03 to 0.2 deg each on surrogate drives), whose mean depends on
/// the scenery: so much is added to the sigma of each drive.
inline constexpr double kScenerySigma_deg = 0.03;

struct ElevationEstimate {
  double angle_deg = 0.0;  ///< to be added to the elevations
  double sigma_deg = 0.0;  ///< above 0
};

/// What a drive itself tells, without the sigma that it began with: the error that it found, and its sigma. Nothing if
/// that is hardly more than it began with.
std::optional<ElevationEstimate> withoutPrior(const ElevationEstimate& found, double prior_sigma_deg);

/// sigma_deg: with the scenery's part. Throws InputError without estimates, and where a number is not finite or a sigma
/// is not above 0.
ElevationEstimate meanElevation(const std::vector<ElevationEstimate>& drives);

}  // namespace fail_aware
