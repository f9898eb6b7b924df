// The newest sweep's place on the road, found by its road profile among those of the sweeps before it. Not in the
// paper.
//
// The earlier profiles lie at their estimated poses and are averaged into one map of the road. The newest one is moved
// along the road; its place is where it correlates best with the map. Nothing is assumed of the motion between the
// sweeps. Sweeps within two metres of the newest one are left out: what changes slowly in the sensor's frame (a vehicle
// that pitches) is nearly the same in them, and would hold the newest sweep at their place.
// sigma: what noise of the heights explains, sqrt((1 - c^2) / (c n c'')) with the correlation c, its curvature c'' and
// n cells, times kNoiseFactor: against the registered poses, errors are 3 to 5 times as large (surrogate roads 0.06 m,
// in town 0.2 m; KITTI's highway and town 0.2 m).
//
// Failure: nullopt, if too few sweeps lie far enough behind, or no place fits distinctly. Cost: 0.3 ms.
#pragma once

#include <optional>
#include <vector>

#include "core/aiding/road_profile_window.hpp"

namespace fail_aware {

struct RoadPlace {
  double offset_m = 0.0;  ///< along the vehicle's axis, from the predicted place
  double sigma_m = 0.0;
  double correlation = 0.0;  ///< of the heights at this place
};

constexpr double kAlike_m = 1.0;  ///< half a wave of the profile

/// `profiles`: RoadProfileWindow::profiles(kAlike_m). max_offset_m: farthest place that is searched, ahead and behind.
/// profile_sigma_m: height of the profile.
std::optional<RoadPlace> findRoadPlace(const std::vector<RoadProfile>& profiles, double cell_m, double profile_sigma_m,
                                       double max_offset_m);

}  // namespace fail_aware
