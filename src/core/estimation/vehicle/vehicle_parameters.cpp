#include "core/estimation/vehicle/vehicle_parameters.hpp"

#include "core/parameters/check.hpp"

namespace fail_aware {

void VehicleParameters::validate() const {
  visit(*this, [this](const char* name, const double& value) {
    const bool may_be_zero = &value == &damper_front_ns_per_m || &value == &damper_rear_ns_per_m ||
                             &value == &cog_above_roll_axis_m || &value == &cog_above_pitch_axis_m;
    if (may_be_zero) {
      requireNotNegative(name, value);
    } else {
      requirePositive(name, value);
    }
  });
  requireParameter(mass_kg >= 50.0, "mass_kg", mass_kg, "at least 50: kg, not t");
}

}  // namespace fail_aware
