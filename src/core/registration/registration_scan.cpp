#include "core/registration/registration_scan.hpp"

namespace fail_aware {

void RegistrationScan::redeskewTo(const Vector6d& other_twist_cog, double still_s) {
  cloud.redeskewBy(other_twist_cog - twist_cog, still_s);
  twist_cog = other_twist_cog;
}

void RegistrationScanBuilder::build(const CorrectedSweep& sweep, const SweepPrediction& prediction,
                                    const Pose& T_cog_lidar, RegistrationScan& scan) {
  builder_.build(sweep, T_cog_lidar, scan.cloud, beam_bias_estimator_.bias());
  scan.T_cog_lidar = T_cog_lidar;
  scan.twist_cog.setZero();
  if (!prediction.isFirst()) scan.twist_cog = logSe3(prediction.T_previous_now()) / prediction.dt_s;
  scan.usable = static_cast<int>(scan.cloud.map_points_cog.size()) >= builder_.params().min_points;
}

void RegistrationScanBuilder::observeBeams(const RegistrationScan& scan, const VoxelMap& map, const Pose& T_odom_cog) {
  beam_bias_estimator_.observe(scan.cloud.plane_points_cog, scan.cloud.plane_rings, scan.T_cog_lidar, map, T_odom_cog);
}

}  // namespace fail_aware
