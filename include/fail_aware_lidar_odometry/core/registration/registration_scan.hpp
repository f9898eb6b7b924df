// A sweep as the two ICPs register it: its thinned clouds, and the motion that they are deskewed for.
//
// The builder corrects the ranges for what the beams were found to be off by (beam_range_bias.hpp). Of a sweep that came
// compensated (sensor.timing.source none) it is not known for which motion it was moved.
// Frames: the centre of gravity's. Cost: registration_cloud.hpp's and beam_range_bias.hpp's.
#pragma once

#include "fail_aware_lidar_odometry/core/registration/beam_range_bias.hpp"
#include "fail_aware_lidar_odometry/core/registration/registration_cloud.hpp"
#include "fail_aware_lidar_odometry/core/registration/registration_parameters.hpp"
#include "fail_aware_lidar_odometry/core/types/corrected_sweep.hpp"
#include "fail_aware_lidar_odometry/core/types/sweep_prediction.hpp"

namespace fail_aware {

struct RegistrationScan {
  RegistrationCloud cloud;
  Pose T_cog_lidar = Pose::Identity();
  /// The motion that the cloud is deskewed for (compensated: the predicted one), m/s and rad/s.
  Vector6d twist_cog = Vector6d::Zero();
  bool usable = false;  ///< false: too few points in range, the sweep cannot be registered

  /// Deskews the cloud for another motion. What was measured at still_s (relative to the stamp) stays where it is.
  void redeskew(const Vector6d& other_twist_cog, double still_s);
};

class RegistrationScanBuilder {
 public:
  /// timing: SensorParameters::correctedTiming(); says whether sweeps come compensated, and how the head turns.
  RegistrationScanBuilder(const RegistrationParameters& params, const SweepTimingParams& timing);

  /// The sweep, deskewed as predicted. `scan` is reused.
  void build(const CorrectedSweep& sweep, const SweepPrediction& prediction, const Pose& T_cog_lidar,
             RegistrationScan& scan);

  /// What beams are off by, from a scan at its estimate before it joins the map.
  void observeBeams(const RegistrationScan& scan, const VoxelMap& map, const Pose& T_odom_cog);

  void reset() { beam_range_bias_.reset(); }

 private:
  RegistrationCloudBuilder builder_;
  BeamRangeBias beam_range_bias_;
};

}  // namespace fail_aware
