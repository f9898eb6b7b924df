// What the references (local map, corners) do with a sweep. The estimator decides it
// (estimation/map_update_policy.hpp). Beside it, LocalMapRegistration clears the points of its map where they cannot be
// registered against: the road shows another speed than the one they were placed with, or no first motion is found in
// time. Such a sweep has the status kNoReference. When a pose is set (FilterState::odom_reset_count), both references
// are cleared.
#pragma once

#include <cstdint>

namespace fail_aware {

enum class MapUpdate : std::uint8_t {
  kSkip = 0,    ///< not inserted into the map: its pose is not measured well enough (corners need no roll and pitch)
  kInsert = 1,  ///< the sweep is inserted at its estimate
  kRestart = 2  ///< the references are cleared and begin with this sweep; its pose error affects all later sweeps
};
constexpr MapUpdate lastOf(MapUpdate) { return MapUpdate::kRestart; }

}  // namespace fail_aware
