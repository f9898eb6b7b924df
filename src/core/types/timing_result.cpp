#include "core/types/timing_result.hpp"

namespace fail_aware {

const char* toString(TimingSource source) {
  switch (source) {
    case TimingSource::kNone: return "none";
    case TimingSource::kField: return "field";
    case TimingSource::kAzimuth: return "azimuth";
    case TimingSource::kHeld: return "held";
  }
  return "unknown";
}

const char* toString(StampReference reference) {
  switch (reference) {
    case StampReference::kStart: return "start";
    case StampReference::kMid: return "mid";
    case StampReference::kEnd: return "end";
  }
  return "unknown";
}

const char* toString(TimeField field) {
  switch (field) {
    case TimeField::kNotRead: return "not_read";
    case TimeField::kUsed: return "used";
    case TimeField::kAbsent: return "absent";
    case TimeField::kNotFinite: return "not_finite";
    case TimeField::kNoSpread: return "no_spread";
    case TimeField::kBadScale: return "bad_scale";
    case TimeField::kBackward: return "backward";
  }
  return "unknown";
}

}  // namespace fail_aware
