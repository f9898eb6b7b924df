#include "core/estimation/vehicle/vehicle_parameters.hpp"

namespace fail_aware {

void VehicleParameters::checkRules() const {
  requireParameter(mass_kg >= 50.0, "mass_kg", mass_kg, "at least 50: kg, not t");
}

}  // namespace fail_aware
