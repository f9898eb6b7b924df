#include "core/registration_parameters.hpp"

#include "core/parameters/check.hpp"
#include "core/parameters/validate_nested.hpp"

namespace fail_aware {

void RegistrationParameters::validate() const {
  requireParameter(use_icp_point_to_point || use_icp_point_to_plane, "use_icp_point_to_point", use_icp_point_to_point,
                   "true, or use_icp_point_to_plane be true (corners alone cannot find the first motion)");
  validateNested(*this);
}

}  // namespace fail_aware
