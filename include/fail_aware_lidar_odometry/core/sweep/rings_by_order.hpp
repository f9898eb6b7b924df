// Laser numbers of a sweep without them, from the order of its points.
//
// KITTI's files (raw and odometry, HDL-64E), and bags made of them, have no rings but list the points beam by beam: the
// highest beam first, each beam counter-clockwise from straight ahead, azimuth 0 to 360 deg. Where the azimuth falls back
// the next beam begins. (At the rear it steps back, too, in sweeps whose motion KITTI has taken out: by the few degrees that
// the vehicle turned.) Source: the scans themselves; of 230 complete ones all but one have 64 beams by this rule.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace fail_aware {

/// One laser number a point, 0 = lowest beam, 63 = highest. Empty where the points are in another order: not 64 beams (one
/// without any return shifts all others), or their mean elevations do not fall from beam to beam.
/// `points_lidar`: m, sensor frame. Cost: about 1 ms for 120 000 points.
std::vector<std::uint16_t> ringsByOrder(const std::vector<Eigen::Vector3f>& points_lidar);

}  // namespace fail_aware
