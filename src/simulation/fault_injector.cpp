#include "simulation/fault_injector.hpp"

#include <utility>

#include "simulation/random.hpp"
#include "simulation/sweep_faults.hpp"

namespace fail_aware {

const Fault* FaultInjector::active(FaultKind kind, double begin_s) const {
  for (const Fault& fault : faults_) {
    if (fault.kind == kind && fault.active(begin_s)) return &fault;
  }
  return nullptr;
}

bool FaultInjector::strikes(FaultKind kind, const SimulatedSweep& sweep) const {
  const Fault* fault = active(kind, sweep.begin_s);
  return fault && uniformFromBits(combineKeys(seed_, 81, static_cast<std::uint64_t>(kind), index_)) < fault->severity;
}

void FaultInjector::applyToPoints(SimulatedSweep& sweep, const Fault& fault, std::uint64_t key) const {
  Sweep& points = sweep.sweep;
  switch (fault.kind) {
    case FaultKind::kBlankedSector: blankSector(points, fault.severity); return;
    case FaultKind::kLostRings: loseRings(points, fault.severity, seed_); return;
    case FaultKind::kRangeCap: capRange(points, fault.severity); return;
    case FaultKind::kNoise: addNoise(points, fault.severity, key); return;
    case FaultKind::kGhostPoints: addGhosts(points, fault.severity, key); return;
    case FaultKind::kHalfSweep: cutShort(points, fault.severity); return;
    case FaultKind::kTiltedMount: tiltMount(points, fault.severity); return;
    case FaultKind::kEmptyCloud: makeEmpty(points); return;
    case FaultKind::kNan: makeNan(points, fault.severity, key); return;
    case FaultKind::kStampJump: points.stamp_s += fault.severity; return;
    case FaultKind::kStampJitter: points.stamp_s += fault.severity * normalFromBits(combineKeys(key, 83)); return;
    case FaultKind::kTimeSign: sweep.time_sign_wrong = true; return;
    case FaultKind::kFrozenCloud:
    case FaultKind::kDropped:
    case FaultKind::kDuplicated:
    case FaultKind::kReordered:
    case FaultKind::kDenseTraffic: return;
  }
}

std::vector<SimulatedSweep> FaultInjector::apply(SimulatedSweep sweep) {
  const std::uint64_t key = combineKeys(seed_, 82, index_++);
  if (active(FaultKind::kFrozenCloud, sweep.begin_s)) {
    const double stamp_s = sweep.sweep.stamp_s;
    if (frozen_) sweep.sweep = *frozen_;
    sweep.sweep.stamp_s = stamp_s;
  }
  frozen_ = sweep.sweep;
  for (const Fault& fault : faults_) {
    if (fault.active(sweep.begin_s)) applyToPoints(sweep, fault, key);
  }

  std::vector<SimulatedSweep> arriving;
  if (strikes(FaultKind::kDropped, sweep)) return arriving;
  if (held_) {
    arriving.push_back(std::move(sweep));
    arriving.push_back(std::move(*held_));
    held_.reset();
    return arriving;
  }
  if (strikes(FaultKind::kReordered, sweep)) {
    held_ = std::move(sweep);
    return arriving;
  }
  if (strikes(FaultKind::kDuplicated, sweep)) arriving.push_back(sweep);
  arriving.push_back(std::move(sweep));
  return arriving;
}

std::vector<SimulatedSweep> FaultInjector::flush() {
  std::vector<SimulatedSweep> arriving;
  if (held_) arriving.push_back(std::move(*held_));
  held_.reset();
  return arriving;
}

}  // namespace fail_aware
