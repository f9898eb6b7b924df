// One input of the fusion (estimation/measurement_fusion.hpp): a measurement and the name of its source.
#pragma once

#include <string>

#include "core/types/measurement.hpp"

namespace fail_aware {

struct FusionInput {
  std::string name;
  const Measurement* measurement = nullptr;  ///< null or not ok(): absent. Not owned
  bool external = false;  ///< not from the sweep: disagrees with another input only beyond both covariances (3 sigma)
};

}  // namespace fail_aware
