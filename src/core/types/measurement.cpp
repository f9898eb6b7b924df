#include "core/types/measurement.hpp"

namespace fail_aware {

const char* toString(MeasurementStatus status) {
  switch (status) {
    case MeasurementStatus::kOk: return "ok";
    case MeasurementStatus::kNoReference: return "no_reference";
    case MeasurementStatus::kTooFewPoints: return "too_few_points";
    case MeasurementStatus::kNotConverged: return "not_converged";
    case MeasurementStatus::kDegenerate: return "degenerate";
    case MeasurementStatus::kTooFewCorners: return "too_few_corners";
  }
  return "unknown";
}

}  // namespace fail_aware
