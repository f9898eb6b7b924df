// What stands above the ground in one sweep, kept as the reference of the above-ground match
// (above_ground_matcher.hpp). Not in the paper.
//
// One sweep is kept for some metres, then another one. A sweep in which much stands is none: the match is for open
// country; the next one is kept as late as after any other.
// Frames: points of the centre of gravity; poses odom. Cost: two hash probes a point, of the sweeps that are kept.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/map/above_ground_points.hpp"
#include "core/map/voxel_map.hpp"

namespace fail_aware {

class AboveGroundReference {
 public:
  struct Params {
    bool enabled = true;                            ///< false: nothing is ever kept
    AboveGroundPointsParams points{4.0, 0.5, 0.4};  ///< places of 4 m, which have one vote each: a bush, or a car
    double max_range_m = 100.0;                     ///< farthest points used: all that registration uses
    double max_above_ground_ratio = 0.1;            ///< of the points that stand: on a motorway a seventh do
    double max_distance_m = 10.0;                   ///< farthest from the sweep that is kept; then it is another one
    double max_age_s = 1.0;                         ///< likewise in time
  };

  explicit AboveGroundReference(const Params& params);

  /// The sweep that later ones are matched with; none if too much stands in it.
  void keep(const std::vector<Eigen::Vector3f>& points_cog, const Pose& T_odom_cog, double stamp_s);

  /// It is time to keep another: the last was too far or too long ago, whether kept or not, or there was none.
  bool isDue(const Pose& T_odom_cog, double stamp_s) const;

  void clear();

  /// In odom; empty: nothing is kept.
  const VoxelMap& map() const { return map_; }
  const Pose& T_odom_cog() const { return T_odom_cog_; }

 private:
  Params params_;
  VoxelMap map_;
  Pose T_odom_cog_ = Pose::Identity();
  std::optional<double> stamp_s_;  ///< of the sweep that was kept, or would have been
};

}  // namespace fail_aware
