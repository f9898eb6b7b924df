// How the points of a sweep were timed, and whether the driver's time field could be used (sweep/timing.hpp).
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace fail_aware {

/// Where the points' times come from; kHeld: as in the sweeps before (sweep/held_timing.hpp).
enum class TimingSource { kNone, kField, kAzimuth, kHeld };
/// The instant of the sweep that its stamp means.
enum class StampReference { kStart, kMid, kEnd };

enum class TimingStatus {
  kOk,
  kOff,         ///< `source` is none
  kEmptySweep,  ///< no point
  kNoField      ///< `source` is field, and the field cannot be used: see TimingResult::field
};

/// Whether the driver's time field was used, and why not.
enum class TimeField {
  kNotRead,  ///< `source` is none or azimuth, or the sweep is empty
  kUsed,
  kAbsent,     ///< none, or not one per point
  kNotFinite,  ///< more than a tenth of the values are NaN or infinite
  kNoSpread,   ///< the same value everywhere
  kBadScale    ///< in no unit the times of a sweep, or too coarse
};

const char* toString(TimingSource source);
const char* toString(StampReference reference);
const char* toString(TimingStatus status);
const char* toString(TimeField field);

struct TimingResult {
  TimingStatus status = TimingStatus::kOff;
  TimeField field = TimeField::kNotRead;
  TimingSource source = TimingSource::kNone;
  StampReference reference = StampReference::kEnd;
  std::optional<StampReference> field_reference{};  ///< from the signs of the field's times, where it is used
  double period_s = 0.1;                            ///< of a sweep
  bool period_known = false;                        ///< given or measured; otherwise nominal
  std::size_t outliers = 0;                         ///< points without a usable time: NaN
  std::string refusal;  ///< why the field is refused (kNotFinite, kBadScale), for people; else empty

  bool ok() const { return status == TimingStatus::kOk; }
  /// The field was refused, and no sweep before this one shows how to time it.
  bool guessed() const { return !refusal.empty() && source != TimingSource::kHeld; }
};

}  // namespace fail_aware
