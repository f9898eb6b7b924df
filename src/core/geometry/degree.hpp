// One degree. Parameters are in degrees, computations in radians.
#pragma once

#include <cmath>

namespace fail_aware {

constexpr double kDegree = M_PI / 180.0;  ///< rad

}  // namespace fail_aware
