// The registration front as the parameters have it: of the offline pipeline and of the two ICP nodelets.
#pragma once

#include "fail_aware_lidar_odometry/core/pipeline_parameters.hpp"
#include "fail_aware_lidar_odometry/core/registration/registration_front.hpp"

namespace fail_aware {

inline RegistrationFront makeFront(const RegistrationParameters& params) {
  return RegistrationFront(params.cloud, params.reference, params.initialization, params.relief,
                           Relocalization(params.relocalization, params.point),
                           TurnSearch(params.turn_search, params.plane), StandingMatch(params.standing, params.plane),
                           params.refine_correction);
}

}  // namespace fail_aware
