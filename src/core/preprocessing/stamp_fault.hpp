// Checks the assumed reference of the stamps (sensor.timing.stamp_reference) against the other evidence.
#pragma once

#include <cstdio>
#include <string>

#include "core/preprocessing/timing.hpp"

namespace fail_aware {

inline constexpr double kLateFrom_periods = 0.9, kLateTo_periods = 1.6;

/// One line for the user; empty: no contradiction.
/// `age_s`: age of the clouds on arrival (ClockCheck); 0: not known, of a recording. If a stamp is the time of the
/// revolution's first packet, the cloud arrives one period later. If it is the time of the last packet, the age is only
/// the delay of driver and transport. So this function doubts a stamp that is the end of the sweep by default and is
/// always about a period old. A reference that the parameter sets is trusted.
inline std::string stampFault(const SweepTimingParams& params, const TimingResult& timing, double age_s = 0.0) {
  const bool assumed = params.stamp_reference == "auto";
  char text[320];
  if (timing.field_reference && !assumed && *timing.field_reference != timing.reference) {
    std::snprintf(
        text, sizeof text,
        "the points' times say that the stamp is the sweep's %s, and sensor.timing.stamp_reference says %s: set "
        "it to auto, unless these times count from another instant than the stamp",
        toString(*timing.field_reference), toString(timing.reference));
    return text;
  }
  const double periods = age_s / timing.period_s;
  if (timing.source == TimingSource::kAzimuth && assumed && timing.reference == StampReference::kEnd &&
      timing.period_known && periods >= kLateFrom_periods && periods <= kLateTo_periods) {
    std::snprintf(text, sizeof text,
                  "the clouds come %.3f s after their stamp, which is taken for the end of a sweep of %.3f s: if it is "
                  "that of the first packet, set sensor.timing.stamp_reference to start (otherwise to end), or the "
                  "poses are off by a sweep's motion",
                  age_s, timing.period_s);
    return text;
  }
  return "";
}

}  // namespace fail_aware
