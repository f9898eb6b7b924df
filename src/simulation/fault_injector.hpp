// Applies a drive's faults to its sweeps in order: faults of single sweeps (sweep_faults.hpp) and faults of their
// sequence. Dense traffic is part of the scene instead: vehiclesAround (fault.hpp).
//
// Pass every sweep in order to apply(), which returns what arrives instead: nothing, one or several sweeps; call
// flush() at the end. Ground truth and begin stay those of the points' sweep; a fault of the stamp changes only
// sweep.stamp_s. Deterministic in seed and input. No failure modes. Cost: one pass over the points per fault.
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
  std::optional<SimulatedSweep> held_;  ///< the first sweep of a pair to be swapped
};

}  // namespace fail_aware
