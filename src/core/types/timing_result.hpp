// How a sweep's points were timed, and whether the driver's time field was usable (preprocessing/timing.hpp).
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace fail_aware {

/// Where the points' times come from; kHeld: as in earlier sweeps (preprocessing/held_timing.hpp). kNone: `source` is
/// none, the sweep is empty, or `source` is field and the field is not usable (TimingResult::field).
enum class TimingSource { kNone, kField, kAzimuth, kHeld };
/// The instant of the sweep that its stamp means.
enum class StampReference { kStart, kMid, kEnd };

/// Whether the driver's time field was used, and why not.
enum class TimeField {
  kNotRead,  ///< `source` is none or azimuth, or the sweep is empty
  kUsed,
  kAbsent,     ///< no field, or not one value per point
  kNotFinite,  ///< more than a tenth of the values are NaN or infinite
  kNoSpread,   ///< all values are equal
  kBadScale,   ///< no unit gives the times of a sweep, or the resolution is too coarse
  kBackward    ///< the times run against the head's sense of rotation
};

const char* toString(TimingSource source);
const char* toString(StampReference reference);
const char* toString(TimeField field);

struct TimingResult {
  TimeField field = TimeField::kNotRead;
  TimingSource source = TimingSource::kNone;
  StampReference reference = StampReference::kEnd;
  std::optional<StampReference> field_reference{};  ///< from the signs of the field's times, if the field is used
  double period_s = 0.1;                            ///< of a sweep
  bool period_known = false;                        ///< given or measured; otherwise by the field, or nominal
  std::size_t outliers = 0;                         ///< points without a usable time: NaN
  std::string refusal;  ///< why the field is refused, for people (a missing one only if `source` is field); else empty

  bool ok() const { return source != TimingSource::kNone; }
  /// The field was refused, and no earlier sweep shows how to time this one.
  bool guessed() const { return !refusal.empty() && source != TimingSource::kHeld; }
};

}  // namespace fail_aware
