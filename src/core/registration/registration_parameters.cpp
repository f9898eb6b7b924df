#include "fail_aware_lidar_odometry/core/registration/registration_parameters.hpp"

#include "fail_aware_lidar_odometry/core/parameters/check.hpp"
#include "fail_aware_lidar_odometry/core/parameters/validate_nested.hpp"

namespace fail_aware {

void RegistrationParameters::validate() const {
  requireParameter(use_point || use_plane, "use_point", use_point,
                   "true, or use_plane be true (corners alone cannot find the first motion)");
  validateNested(*this);
}

}  // namespace fail_aware
