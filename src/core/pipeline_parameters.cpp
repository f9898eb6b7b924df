#include "core/pipeline_parameters.hpp"

#include <cmath>

namespace fail_aware {

Pose SensorParameters::T_base_lidar() const { return mountingPose(lidar_in_base); }

SweepTimingParams SensorParameters::correctedTiming() const {
  SweepTimingParams corrected = timing;
  if (azimuth.angle_deg != 0.0) {
    corrected.start_azimuth_deg = std::remainder(timing.start_azimuth_deg + azimuth.angle_deg, 360.0);
  }
  return corrected;
}

Pose VehicleFileParameters::T_base_cog() const {
  Pose T = Pose::Identity();
  T.translation() = Eigen::Vector3d(cog_in_base.data());
  return T;
}

}  // namespace fail_aware
