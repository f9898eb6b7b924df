// How well the above-ground points of a sweep meet those of an earlier sweep at a pose. Used by the search for the first
// motion (motion_initialization.hpp), which explains the votes, and by drive_off.hpp. Not in the paper.
//
// Frames: T_first_now maps the vehicle's frame at the sweep into its frame at the first one.
// Failure: without a point the log likelihood is 0, and nothing is met.
// Cost: 0.2 ms for 2000 points.
#pragma once

#include "core/geometry/pose.hpp"
#include "core/initial_guess/occlusion_image.hpp"
#include "core/map/above_ground_points.hpp"
#include "core/map/voxel_map.hpp"

namespace fail_aware {

struct FirstSweepMatch {
  double log_likelihood = 0.0;  ///< of the votes: comparable at poses of the same sweep
  double votes = 0.0;           ///< of the places: how many meet, by degrees
  double met_ratio = 0.0;       ///< of the places
};

/// Points that the first sweep could not see, as another object hid them.
enum class HiddenPoints { kMeetNothing, kHaveAVote };

/// Refers to its arguments, which must outlive it.
class FirstSweepMatcher {
 public:
  FirstSweepMatcher(const AboveGroundPoints& now, const VoxelMap& first, const OcclusionImage& hidden_in_first)
      : now_(now), first_(first), hidden_in_first_(hidden_in_first) {}

  /// kernel_m: Geman-McClure scale of the distance to the nearest point of the first sweep.
  FirstSweepMatch match(const Pose& T_first_now, double kernel_m, HiddenPoints hidden) const;

  double places() const { return static_cast<double>(now_.places); }

 private:
  const AboveGroundPoints& now_;
  const VoxelMap& first_;
  const OcclusionImage& hidden_in_first_;
};

}  // namespace fail_aware
