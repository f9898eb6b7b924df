#include "core/pipeline_parameters.hpp"

#include <cmath>

#include "core/parameters/check.hpp"
#include "core/parameters/mounting.hpp"
#include "core/parameters/validate_nested.hpp"

namespace fail_aware {

void SensorParameters::validate() const {
  validateNested(*this);
  requireMounting("lidar_in_base", lidar_in_base);
}

Pose SensorParameters::T_base_lidar() const { return mountingPose(lidar_in_base); }

SweepTimingParams SensorParameters::correctedTiming() const {
  SweepTimingParams corrected = timing;
  if (azimuth.angle_deg != 0.0) {
    corrected.start_azimuth_deg = std::remainder(timing.start_azimuth_deg + azimuth.angle_deg, 360.0);
  }
  return corrected;
}

void VehicleFileParameters::validate() const {
  validateNested(*this);
  requireFiniteNumbers("cog_in_base", cog_in_base, 3);
}

Pose VehicleFileParameters::T_base_cog() const {
  Pose T = Pose::Identity();
  T.translation() = Eigen::Vector3d(cog_in_base.data());
  return T;
}

void ProfileParameters::validate() const { validateNested(*this); }

void PipelineParameters::validate() const {
  validateAs("sensor.", sensor);
  validateAs("vehicle.", vehicle);
  profile.validate();
}

}  // namespace fail_aware
