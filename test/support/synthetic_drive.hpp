// Sweeps of a spinning lidar on a vehicle that drives with a constant twist through a synthetic scene.
#pragma once

#include "core/types/corrected_sweep.hpp"
#include "synthetic_scene.hpp"

namespace fail_aware {

struct SyntheticDrive {
  Vector6d twist_cog = Vector6d::Zero();  ///< m/s, rad/s
  Pose T_cog_lidar = poseOf(0.5, 0.0, 1.2, 0.0, 0.0, 0.0);
  Scene scene = street();
  double points_per_m2 = 4.0;
  double max_range_m = 30.0;
  bool car_ahead = false;     ///< 9 m ahead, as fast as the vehicle
  bool ground_rings = false;  ///< the scan lines on flat ground, which travel with the sensor

  Pose pose(double time_s) const { return expSe3(twist_cog * time_s); }

  /// The uncorrected sweep that is centred at its stamp: each point as seen in its own instant.
  CorrectedSweep sweep(double stamp_s, unsigned seed) const;
};

inline Vector6d planarTwist(double speed_mps, double yaw_rate_rps) {
  Vector6d twist = Vector6d::Zero();
  twist[0] = speed_mps;
  twist[5] = yaw_rate_rps;
  return twist;
}

}  // namespace fail_aware
