// The noise parameters under which recorded errors are most likely (Gaussian maximum likelihood). Since all of them
// scale variances, the NEES per degree of freedom over the data is 1 at the optimum; whether it is elsewhere is for
// other data to say.
//
// Increments: error ~ N(0, scale * modelled + floors + doubt), floors as in estimation/pose_filter.hpp.
// Drift: horizontal errors since t1, `every_s` apart up to `until_s`, against estimation/odometry_covariance.hpp's
// covariance; errors of one episode are treated as independent (a composite likelihood), which does not bias the
// estimate.
// Runs where the odometry is lost say nothing about either: leave them out.
//
// Not fitted: the jitter (DriftModel's transient_ratio, transient_rotation_ratio: measured on 79 drives,
// doc/parts_time_to_failure.md), DriftModel's map length and tilt, and the predictor's Student's t
// (degrees_of_freedom), which takes the fitted covariance as its scale. These are chosen by hand, from coverage and
// missed failures of runs.
#pragma once

#include <vector>

#include "core/estimation/drift_model.hpp"
#include "core/estimation/pose_filter.hpp"
#include "core/types/monitor_input.hpp"

namespace fail_aware {

struct IncrementSample {
  Vector6d error = Vector6d::Zero();     ///< evaluation/consistency.hpp's motionError
  Matrix6d modelled = Matrix6d::Zero();  ///< the covariance with increment_scale 1, no floors and no doubt
  Matrix6d doubt = Matrix6d::Zero();     ///< FilterState's: added to the covariance, and scaled by no parameter
  double distance_m = 0.0;
};

/// `params`: those the run was made with; their scale and floors, and the doubt, are taken out of what it logged.
std::vector<IncrementSample> incrementSamples(const std::vector<Pose>& truth, const std::vector<MonitorInput>& log,
                                              const PoseFilter::Params& params);

/// `others` with the four increment_* parameters fitted. Throws InputError for fewer than 10 samples.
PoseFilter::Params fitIncrementNoise(const std::vector<IncrementSample>& samples, const PoseFilter::Params& others);

struct DriftRun {
  std::vector<Pose> truth;  ///< cog, one for each entry of log
  std::vector<MonitorInput> log;
};

struct DriftFitOptions {
  double episode_every_s = 5.0, every_s = 5.0, until_s = 60.0;
};

/// `others` with registration_ratio, position_ and heading_per_root_metre, heading_bias and scale_bias fitted. Throws
/// InputError without data.
DriftModel fitDrift(const std::vector<DriftRun>& runs, const DriftModel& others, const DriftFitOptions& options = {});

}  // namespace fail_aware
