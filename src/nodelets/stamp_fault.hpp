// Does the instant that the stamps are taken for (sensor.timing.stamp_reference) agree with what else is known of it?
#pragma once

#include <cstdio>
#include <string>

#include "core/preprocessing/timing.hpp"

namespace fail_aware {

inline constexpr double kLateFrom_periods = 0.9, kLateTo_periods = 1.6;

/// One line for people; empty: nothing speaks against it.
/// `age_s`: of the clouds on arrival (ClockCheck). Stamps of a revolution's first packet are a period old when the cloud
/// comes; those of its last one are as old as driver and transport are slow. So a stamp that was taken for the end of a
/// sweep by default, and is that old in cloud after cloud, is doubted. One that the parameter says is believed.
inline std::string stampFault(const SweepTimingParams& params, const TimingResult& timing, double age_s) {
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
