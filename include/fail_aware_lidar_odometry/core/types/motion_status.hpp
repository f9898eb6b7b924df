// How well the vehicle's motion is known after a sweep. The estimator alone decides it.
#pragma once

#include <cstdint>

namespace fail_aware {

enum class MotionStatus : std::uint8_t {
  kUnknown = 0,   ///< no motion was measured yet in this drive
  kObserved = 1,  ///< measured in this sweep, in all directions on the road
  /// Carried on by the vehicle model, wholly or along some direction. So is the first motion that is found: it counts
  /// as observed once a sweep that was deskewed with it confirms it.
  kDeadReckoning = 2
};
constexpr MotionStatus lastOf(MotionStatus) { return MotionStatus::kDeadReckoning; }

}  // namespace fail_aware
