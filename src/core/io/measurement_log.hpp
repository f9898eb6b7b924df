// measurements.csv: the vehicle's motion since the previous estimate according to each measurement, with its R, so that
// R can be compared with the ground truth. The NIS cannot do this: it contains the prediction's large covariance.
//
// One row per usable measurement (io/number_table.hpp); units m, rad.
// Failure: readMeasurementLog throws InputError naming file and line.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/types/filter_state.hpp"
#include "core/types/measurement.hpp"

namespace fail_aware {

struct MeasuredMotion {
  std::size_t row = 0;                     ///< of the sweep in the run's trajectory, counted from 0
  std::size_t source = 0;                  ///< its index among the fusion's inputs (SweepResult::sources)
  Pose T_previous_now = Pose::Identity();  ///< of the centre of gravity, from the last estimate to the measured pose
  Matrix6d covariance = Matrix6d::Identity();  ///< R, geometry/pose.hpp's convention, in the axes of the last estimate
};

/// `state`: the filter state of the measured sweep.
MeasuredMotion measuredMotion(std::size_t row, std::size_t source, const Measurement& measurement,
                              const FilterState& state);

/// Without the line break.
std::string measurementLogHeader();
std::string measurementLogRow(const MeasuredMotion& motion);

std::vector<MeasuredMotion> readMeasurementLog(const std::string& path);

}  // namespace fail_aware
