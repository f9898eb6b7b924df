// Which way a vehicle travels in its own frame, from the odometry of its lidar: no ground truth.
//
// The rear axle moves along the vehicle's axis, but for the slip of its tyres, which grows with the lateral
// acceleration. Of a motion from one sweep to the next, x and y (m, in base_link of the first) with the yaw angle w
// (rad),
//
//   y = x (tan psi + w / 2) + w (b - k x^2)
//
// with psi the direction of travel against the x axis (rad, counter-clockwise), b the distance of the frame's origin
// ahead of the rear axle (m) and k the tyres' part (1/m, for sweeps of equal length in time). The three are fitted to
// all motions at once, iteratively reweighted (Cauchy). Motions over gaps and jumps (longer than three times the
// drive's median) are left out.
//
// A steady bend looks like psi: drives with bends to both sides, or straight on, are needed. Stays in psi, and is not
// in its sigma: wheels that are out of line, and a road that falls to one side all the way (0.05 deg or so); a side
// wind, if the way is not driven back.
#pragma once

#include <vector>

#include "core/geometry/pose.hpp"

namespace fail_aware {

struct DirectionOfTravel {
  double direction_deg = 0.0;  ///< psi
  double sigma_deg = 0.0;      ///< jackknife over ten stretches: what follows from one another is not counted twice
  double curvature_ratio =
      0.0;                  ///< of psi's part of the fit that b and k could take; 1: one steady bend, psi is not known
  int motions = 0;          ///< that were used
  double distance_m = 0.0;  ///< of them
};

/// Trajectories: T_base0_base sweep by sweep, each of one drive, all of one lidar on one vehicle. Throws InputError for
/// fewer than 50 motions of at least 0.1 m, and where most of the way is not ahead (more than 45 deg off).
DirectionOfTravel directionOfTravel(const std::vector<std::vector<Pose>>& trajectories);

}  // namespace fail_aware
