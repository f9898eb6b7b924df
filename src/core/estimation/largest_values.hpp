// What is beyond these is no pose and no covariance; below them all that is computed stays finite.
#pragma once

namespace fail_aware {

inline constexpr double kFarthestPose_m = 1e9;    ///< of a position in odom
inline constexpr double kLargestVariance = 1e12;  ///< m^2 or rad^2; "not observed" needs no more

}  // namespace fail_aware
