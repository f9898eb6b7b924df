// The faults of a drive, and their text form KIND[:START[:DURATION[:SEVERITY]]].
//
// START and DURATION in s from the drive's start (DURATION 0 or omitted: the kind's default; "inf": to the end).
// SEVERITY in the kind's own unit, see faultTraits. Failure: ParameterError naming the text and what is wrong with it.
#pragma once

#include <string>
#include <vector>

#include "core/stamp_difference.hpp"

namespace fail_aware {

enum class FaultKind {
  kBlankedSector,
  kLostRings,
  kRangeCap,
  kNoise,
  kGhostPoints,
  kFrozenCloud,
  kHalfSweep,
  kDropped,
  kDuplicated,
  kReordered,
  kStampJump,
  kStampJitter,
  kTimeSign,
  kTiltedMount,
  kDenseTraffic,
  kEmptyCloud,
  kNan,
};

struct FaultTraits {
  FaultKind kind;
  const char* name;
  const char* meaning;  ///< description of the fault and of its severity, for the user
  double severity;      ///< default; limits below
  double min_severity, max_severity;
  double duration_s;  ///< default
};

const std::vector<FaultTraits>& faultTraits();
const FaultTraits& faultTraits(FaultKind kind);

struct Fault {
  FaultKind kind = FaultKind::kEmptyCloud;
  double start_s = 10.0;
  double duration_s = 5.0;  ///< may be infinite
  double severity = 0.0;

  /// Whether the fault acts on a sweep that begins at begin_s.
  bool active(double begin_s) const {
    return begin_s >= start_s - kStampTolerance_s && begin_s < start_s + duration_s - kStampTolerance_s;
  }
  static Fault parse(const std::string& text);
};

/// The description of the faults for `--help`, one line each.
std::string faultHelp();

/// Number of vehicles close around the car (traffic.hpp) during a sweep that begins at begin_s.
int vehiclesAround(const std::vector<Fault>& faults, double begin_s);

}  // namespace fail_aware
