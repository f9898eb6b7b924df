// Where the vehicle is by what stands around it, for open country (not in the paper).
//
// In a field the ground is nearly all that surfaces tell of, and it misleads: its scan lines travel with the sensor, and
// a map of sweeps that were placed at a wrong speed fits the next one at the same wrong speed. A few bushes and posts
// know better but are outnumbered. So where planes hold little (`max_information_share`) and next to nothing stands
// (`max_standing_share`: in a tunnel nearly half of the points do, at a motorway a seventh), horizontal position and
// heading are taken from the standing points alone (standing_points.hpp), matched with those of one sweep that is kept
// for some metres (standing_reference.hpp), a vote each place: a search along the way, then Gauss-Newton over x, y and heading.
//
// A place that fits everywhere nearly as well as at its best (a fence along the road) has no vote. What keeps its
// distance ahead is outside of the window, which is at most half of the way driven since the sweep was kept (but 0.4 m).
//
// Frames: points of the centre of gravity; poses odom. Failure: nothing. Cost: the planes' equations once, of some of
// the points (0.6 ms); in open country 1 to 2 ms more.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "fail_aware_lidar_odometry/core/cloud/voxel_map.hpp"
#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"
#include "fail_aware_lidar_odometry/core/registration/normal_filtered_icp.hpp"
#include "fail_aware_lidar_odometry/core/registration/standing_points.hpp"
#include "fail_aware_lidar_odometry/core/registration/standing_reference.hpp"

namespace fail_aware {

struct StandingPose {
  Pose T_odom_cog;             ///< roll and pitch as predicted, z too but for the way along the vehicle's axis
  Eigen::Matrix3d covariance;  ///< x, y, m, and yaw, rad, odom's axes
};

class StandingMatch {
 public:
  struct Params {
    bool enabled = true;
    double max_information_share = 0.12;  ///< of the weakest horizontal direction among the planes
    double max_standing_share = 0.1;      ///< of the points
    double surface_sigma_m = 0.3;         ///< of what surfaces tell there of the horizontal position
    double surface_sigma_deg = 0.2;       ///< and of the heading
    double max_range_m = 100.0;
    double cell_m = 4.0;
    double column_m = 0.5;
    double min_height_m = 0.4;
    double window_m = 1.0;  ///< along the way, to both sides of the prediction
    double step_m = 0.2;
    double kernel_m = 0.2;      ///< Geman-McClure scale at the end
    double contrast_m = 0.6;    ///< looked so far beyond the window:
    double min_contrast = 0.3;  ///< a place's best less its worst vote, at least
    double sigma_m = 0.25;      ///< of one place
    double min_places = 1.7;
    double max_way_m = 10.0;  ///< since a sweep was kept; then it is another one
    double max_age_s = 1.0;

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("enabled", self.enabled);
      v("max_information_share", self.max_information_share);
      v("max_standing_share", self.max_standing_share);
      v("surface_sigma_m", self.surface_sigma_m);
      v("surface_sigma_deg", self.surface_sigma_deg);
      v("max_range_m", self.max_range_m);
      v("cell_m", self.cell_m);
      v("column_m", self.column_m);
      v("min_height_m", self.min_height_m);
      v("window_m", self.window_m);
      v("step_m", self.step_m);
      v("kernel_m", self.kernel_m);
      v("contrast_m", self.contrast_m);
      v("min_contrast", self.min_contrast);
      v("sigma_m", self.sigma_m);
      v("min_places", self.min_places);
      v("max_way_m", self.max_way_m);
      v("max_age_s", self.max_age_s);
    }
    void validate() const;

    StandingPointsParams points() const { return {cell_m, column_m, min_height_m}; }
    StandingReference::Params reference() const {
      return {enabled, points(), max_range_m, max_standing_share, max_way_m, max_age_s};
    }
  };

  /// `planes`: which pairs count, and how much. Throws ParameterError.
  StandingMatch(const Params& params, const NormalFilteredIcp::Params& planes);

  /// The share of their information that the planes hold of the weakest horizontal direction; 0 without planes.
  double shareOfPlanes(const std::vector<Eigen::Vector3f>& points_cog, const VoxelMap& map,
                       const Pose& T_odom_cog_predicted, double sigma_yaw_rad) const;

  /// What stands within range, less the way that a kept sweep may lie behind.
  StandingPoints select(const std::vector<Eigen::Vector3f>& points_cog) const;

  std::optional<StandingPose> find(const StandingPoints& standing_cog, const StandingReference& reference,
                                   const Pose& T_odom_cog_predicted) const;

  const Params& params() const { return params_; }

 private:
  Params params_;
  NormalFilteredIcp::Params planes_;
};

}  // namespace fail_aware
