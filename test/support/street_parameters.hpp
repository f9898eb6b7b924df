// Parameters for drives through the synthetic street: the default profile with that street's lidar and vehicle.
#pragma once

#include "core/pipeline_parameters.hpp"

namespace fail_aware {
namespace synthetic {

inline PipelineParameters streetParameters() {
  PipelineParameters params;
  params.sensor.timing.stamp_reference = "mid";
  params.sensor.lidar_in_base = {-0.595, 0.0, 1.73, 0.0, 0.0, 0.0};  // synthetic::Lidar's
  params.vehicle.cog_in_base = {0.265, 0.0, 0.543};
  params.profile.registration.initialization.max_speed_mps = 25.0;  // a smaller search is a quicker test
  params.profile.registration.initialization.max_yaw_rate_rps = 0.2;
  return params;
}

}  // namespace synthetic
}  // namespace fail_aware
