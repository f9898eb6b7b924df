// One degree. Parameters state angles in degrees, everything computes in radians.
#pragma once

#include <cmath>

namespace fail_aware {

constexpr double kDegree = M_PI / 180.0;  ///< rad

}  // namespace fail_aware
