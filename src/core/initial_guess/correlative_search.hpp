// Searches for the sweep's pose in the map, seen from above: correlative scan matching (Olson, "Real-Time Correlative
// Scan Matching", ICRA 2009; not in the paper).
//
// The points above the ground are drawn into a grid around the predicted position. Every rotation and shift within the
// search range is tried on a coarse grid, the best ones on a fine grid. The search covers metres and tens of degrees,
// where a nearest-point search ends at the wrong hedge.
//
// Frames: points in the frame of the centre of gravity, poses in odom; z, roll and pitch stay at the prediction.
// Failure: too few points above the ground (false), or too few of them fit at any pose (no pose).
// Cost: 20 to 60 ms.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/map/voxel_map.hpp"
#include "core/parameters/check.hpp"

namespace fail_aware {

struct CorrelativeSearchParams {
  bool enabled = true;
  double range_m = 60.0;      ///< farthest points used: as in the search for the first motion
  double max_shift_m = 15.0;  ///< largest shift from the prediction, along each axis
  /// largest rotation from the prediction, to both sides: more than a vehicle turns in a short gap
  double max_turn_deg = 45.0;
  /// least ratio of above-ground points that must fit (points in unseen areas count half)
  double min_ratio = 0.65;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("enabled", self.enabled);
    v("max_shift_m", self.max_shift_m, within(0.5, 100.0));
  }
};

/// `covariance`: of the predicted pose (SweepPrediction::covariance); it sets the search range. False: too few points
/// above the ground.
bool findByCorrelation(const CorrelativeSearchParams& params, const std::vector<Eigen::Vector3f>& points_cog,
                       const VoxelMap& map, const Pose& T_odom_cog_predicted, const Matrix6d& covariance,
                       std::optional<Pose>& T_odom_cog);

}  // namespace fail_aware
