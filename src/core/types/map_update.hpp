// What the references (local map, corners) do with a sweep. Only the estimator decides it
// (estimation/map_update_policy.hpp).
#pragma once

#include <cstdint>

namespace fail_aware {

enum class MapUpdate : std::uint8_t {
  kSkip = 0,    ///< the sweep is not inserted: its pose is not measured well enough
  kInsert = 1,  ///< the sweep is inserted at its estimate
  kRestart = 2  ///< the references are cleared and begin with this sweep; its pose error affects all later sweeps
};
constexpr MapUpdate lastOf(MapUpdate) { return MapUpdate::kRestart; }

}  // namespace fail_aware
