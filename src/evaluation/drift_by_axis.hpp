// The drift over a segment, axis by axis: which way the odometry errs, where the KITTI metric says only how far.
//
// Segments as in kitti_metric.hpp. The error of a segment is the estimated motion against the true one, seen from its
// first pose: along the line to its true end, across (to the left), and up (the vehicle's z axis there); its rotation
// is the angles of (true rotation)^-1 (estimated rotation). Means of absolute values, divided by the segment's nominal
// length.
//
// Both trajectories in the same moving frame, x ahead and z up, pose by pose (equal counts, else InputError). No
// segment: `segments` 0 and errors 0. Cost: as the KITTI metric.
#pragma once

#include <cstddef>
#include <vector>

#include "evaluation/kitti_metric.hpp"

namespace fail_aware {

struct DriftByAxis {
  double length_m = 0.0;
  std::size_t segments = 0;
  double along_percent = 0.0, across_percent = 0.0, up_percent = 0.0;
  double roll_deg_per_m = 0.0, pitch_deg_per_m = 0.0, yaw_deg_per_m = 0.0;
};

/// One entry a length, in the order of params.lengths_m.
std::vector<DriftByAxis> driftByAxis(const std::vector<Pose>& truth, const std::vector<Pose>& estimate,
                                     const KittiMetric::Params& params = {});

}  // namespace fail_aware
