// Which way a vehicle travels in its own frame, from the odometry of its lidar: no ground truth.
//
// The rear axle moves along the vehicle's axis, but for the slip of its tyres, which grows with the lateral acceleration.
// Of a motion from one sweep to the next, x and y (m, in base_link of the first) with the yaw angle w (rad),
//
//   y = x (tan psi + w / 2) + w (b - k x^2)
//
// with psi the direction of travel against the x axis (rad, counter-clockwise), b the distance of the frame's origin
// ahead of the rear axle (m) and k the tyres' part (1/m, for sweeps of equal length in time). The three are fitted to all
// motions at once, iteratively reweighted (Cauchy), so that single false motions count little.
//
// What it cannot tell from psi: a road that falls to one side all the way, on which a vehicle travels a little askew;
// a side wind; wheels out of line. Motions of several drives, both ways along the same roads, take most of that out.
#pragma once

#include <vector>

#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"

namespace fail_aware {

struct DirectionOfTravel {
  double azimuth_deg = 0.0;  ///< psi
  double sigma_deg = 0.0;    ///< jackknife over ten stretches: what follows from one another is not counted twice
  int motions = 0;           ///< of at least 0.1 m
  double way_m = 0.0;        ///< of them
};

/// Trajectories: T_base0_base sweep by sweep, each of one drive, all of one lidar on one vehicle. Throws InputError for
/// fewer than 50 motions.
DirectionOfTravel directionOfTravel(const std::vector<std::vector<Pose>>& trajectories);

}  // namespace fail_aware
