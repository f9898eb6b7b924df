// The near side of upright objects (not in the paper).
//
// A lidar sees the side of a post, a trunk or a bush that faces it. While the vehicle passes, that side moves around
// the object in the direction of travel. If the near sides of two sweeps are matched as one place, the distance driven
// becomes too short (doc/parts.md, "Near sides"). The edge of a house, which looks like a post, does not move around.
// Units m; directions: horizontal unit vectors in odom, from the centre of gravity to the object.
#pragma once

#include <Eigen/Core>

namespace fail_aware {

/// From what stands to the near side that nearest neighbours match: 0.02 to 0.035 m for posts that are 0.12 m thick,
/// 0.03 to 0.1 m for bales and trees (two simulated fields).
constexpr double kNearSide_m = 0.03;

/// How far the near side has moved between two views.
inline Eigen::Vector2d nearSideShift(const Eigen::Vector2d& direction_before, const Eigen::Vector2d& direction_now) {
  return kNearSide_m * (direction_before - direction_now);
}

}  // namespace fail_aware
