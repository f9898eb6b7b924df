// Limits of positions and variances: within them everything that is computed stays finite.
#pragma once

namespace fail_aware {

inline constexpr double kFarthestPose_m = 1e9;    ///< of a position in odom
inline constexpr double kLargestVariance = 1e12;  ///< m^2 or rad^2; "not observed" needs no more
/// m^2 or rad^2: below it a variance counts as this, so that nothing is divided by zero.
inline constexpr double kSmallestFusedVariance = 1e-14;

}  // namespace fail_aware
