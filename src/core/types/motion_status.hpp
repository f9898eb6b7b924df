// How well the vehicle's motion is known after a sweep. Only the estimator decides it.
#pragma once

#include <cstdint>

namespace fail_aware {

enum class MotionStatus : std::uint8_t {
  kUnknown = 0,   ///< no motion was measured yet, or the search for it starts again
  kObserved = 1,  ///< measured in this sweep, in all horizontal directions
  /// Predicted by the vehicle model, in all or some directions. Also after the search for the first motion, until a
  /// sweep that was deskewed for this motion confirms it.
  kDeadReckoning = 2
};
constexpr MotionStatus lastOf(MotionStatus) { return MotionStatus::kDeadReckoning; }

}  // namespace fail_aware
