// What the estimator alone decides after each sweep: how well the motion is known, and what the references do with the
// sweep.
#pragma once

#include <cstdint>

namespace fail_aware {

/// How well the vehicle's motion is known.
enum class MotionStatus : std::uint8_t {
  kUnknown = 0,   ///< no motion was measured yet, or the search for it starts again
  kObserved = 1,  ///< measured in this sweep, in all horizontal directions
  /// Predicted by the vehicle model, in all or some directions. Also after the search for the first motion, until a
  /// sweep that was deskewed for this motion confirms it.
  kDeadReckoning = 2
};
constexpr MotionStatus lastOf(MotionStatus) { return MotionStatus::kDeadReckoning; }

/// What the references (local map, corners) do with a sweep (estimation/map_update_policy.hpp). Beside it,
/// LocalMapRegistration clears the points of its map where they cannot be registered against: the road shows another
/// speed than the one they were placed with, or no first motion is found in time. Such a sweep has the status
/// kNoReference. When a pose is set (FilterState::odom_reset_count), both references are cleared.
enum class MapUpdate : std::uint8_t {
  kSkip = 0,    ///< not inserted into the map: its pose is not measured well enough (corners need no roll and pitch)
  kInsert = 1,  ///< the sweep is inserted at its estimate
  kRestart = 2  ///< the references are cleared and begin with this sweep; its pose error affects all later sweeps
};
constexpr MapUpdate lastOf(MapUpdate) { return MapUpdate::kRestart; }

}  // namespace fail_aware
