#include "core/registration_parameters.hpp"

#include "core/parameters/check.hpp"

namespace fail_aware {

void RegistrationParameters::checkRules() const {
  requireParameter(use_icp_point_to_point || use_icp_point_to_plane, "use_icp_point_to_point", use_icp_point_to_point,
                   "true, or use_icp_point_to_plane be true (corners alone cannot find the first motion)");
}

}  // namespace fail_aware
