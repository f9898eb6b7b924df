// Applies a drive's faults to its sweeps, one after the other: those on single sweeps (sweep_faults.hpp) and those on
// their sequence. Dense traffic is not here but in the scene: vehiclesAround (fault.hpp).
//
// Give every sweep in order to apply(), which returns what arrives in its place: nothing, one or several; flush() at
// the end. Truth and begin stay those of the points' sweep; only sweep.stamp_s is what a fault makes of it.
// Deterministic in seed and input. No failure modes. Cost: that of the faults' passes over the points.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "simulation/drive_simulation.hpp"
#include "simulation/fault.hpp"

namespace fail_aware {

class FaultInjector {
 public:
  FaultInjector(std::uint64_t seed, const std::vector<Fault>& faults) : seed_(seed), faults_(faults) {}

  std::vector<SimulatedSweep> apply(SimulatedSweep sweep);
  std::vector<SimulatedSweep> flush();

 private:
  void applyToPoints(SimulatedSweep& sweep, const Fault& fault, std::uint64_t key) const;
  const Fault* active(FaultKind kind, double begin_s) const;
  bool strikes(FaultKind kind, const SimulatedSweep& sweep) const;

  std::uint64_t seed_;
  std::vector<Fault> faults_;
  std::uint64_t index_ = 0;
  std::optional<Sweep> frozen_;
  std::optional<SimulatedSweep> held_;  ///< the first of a pair that is swapped
};

}  // namespace fail_aware
