// What the references (local map, corners) do with a sweep. The estimator alone decides it (filter/map_update_policy.hpp).
#pragma once

#include <cstdint>

namespace fail_aware {

enum class MapUpdate : std::uint8_t {
  kSkip = 0,    ///< the sweep does not join: its pose is not measured well enough
  kInsert = 1,  ///< the sweep joins at its estimate
  kRestart = 2  ///< the references are emptied and begin with this sweep; the estimate's error is in all that follows
};
constexpr MapUpdate lastOf(MapUpdate) { return MapUpdate::kRestart; }

}  // namespace fail_aware
