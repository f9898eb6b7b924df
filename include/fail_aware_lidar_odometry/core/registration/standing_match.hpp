// Where the vehicle is by what stands around it, for open country (not in the paper).
//
// In a field the ground is nearly all that surfaces tell of, and it misleads: its scan lines travel with the sensor, and
// a map of sweeps that were placed at a wrong speed fits the next one at the same wrong speed. A few bushes and posts
// know better but are outnumbered. So where planes hold little (`max_information_share`) and next to nothing stands
// (`max_standing_share`: in a tunnel nearly half of the points do, at a motorway a seventh), horizontal position and
// heading are taken from the standing points alone (standing_points.hpp), matched with those of one sweep that is kept
// for some metres, a vote each place: a search along the way, then Gauss-Newton over x, y and heading.
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

namespace fail_aware {

struct StandingPose {
  Pose T_odom_cog;             ///< roll and pitch as predicted, z too but for the way along the vehicle's axis
  Eigen::Matrix3d covariance;  ///< x, y, m, and yaw, rad, odom's axes
};

class StandingMatch {
 public:
  struct Params {
    bool enabled = true;
    /// of the weakest horizontal direction among the planes: a street has more
    double max_information_share = 0.12;
    /// of the points: between open country and a motorway (a seventh), see above
    double max_standing_share = 0.1;
    /// of what surfaces tell there of the horizontal position: a third of the way of a sweep at 10 m/s
    double surface_sigma_m = 0.3;
    double surface_sigma_deg = 0.2;  ///< and of the heading
    double max_range_m = 100.0;      ///< of the points used: all that registration takes
    double cell_m = 4.0;             ///< side of a place; each has one vote: a bush, or a car
    double column_m = 0.5;           ///< side of the columns in which height is measured, as the first motion's search
    double min_height_m = 0.4;       ///< above the lowest of its column: a point that stands
    double window_m = 1.0;           ///< along the way, to both sides of the prediction: ten m/s wrong at 10 Hz
    double step_m = 0.2;             ///< of the search: as the kernel
    double kernel_m = 0.2;           ///< Geman-McClure scale at the end: a bush seen again
    double contrast_m = 0.6;         ///< looked so far beyond the window, three steps:
    /// a place's best less its worst vote, at least: a fence along the road has less
    double min_contrast = 0.3;
    double sigma_m = 0.25;    ///< of one place: what a bush's points scatter from sweep to sweep
    double min_places = 1.7;  ///< fewer say nothing: one place has no heading
    /// since a sweep was kept; then it is another one, before the same things look different
    double max_way_m = 10.0;
    double max_age_s = 1.0;  ///< likewise in time

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("enabled", self.enabled);
    }
    void validate() const;
  };

  /// `planes`: which pairs count, and how much. Throws ParameterError.
  StandingMatch(const Params& params, const NormalFilteredIcp::Params& planes);

  /// The share of their information that the planes hold of the weakest horizontal direction; 0 without planes.
  double shareOfPlanes(const std::vector<Eigen::Vector3f>& points_cog, const VoxelMap& map,
                       const Pose& T_odom_cog_predicted, double sigma_yaw_rad) const;

  /// What stands within range, less the way that a kept sweep may lie behind.
  StandingPoints select(const std::vector<Eigen::Vector3f>& points_cog) const;

  /// The sweep that later ones are matched with; forgotten if too much stands in it.
  void keep(const std::vector<Eigen::Vector3f>& points_cog, const Pose& T_odom_cog, double stamp_s);

  /// It is time to keep another: the last was too far or too long ago, whether kept or not, or there was none.
  bool isDue(const Pose& T_odom_cog, double stamp_s) const;

  std::optional<StandingPose> find(const StandingPoints& standing_cog, const Pose& T_odom_cog_predicted) const;

  void clear();

  const Params& params() const { return params_; }

 private:
  StandingPoints standingWithin(double range_m, const std::vector<Eigen::Vector3f>& points_cog,
                                std::size_t enough) const;
  struct Fit {
    double votes = 0.0;
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
  };
  Fit fit(const StandingPoints& standing, const std::vector<bool>& has_vote, const Pose& T_odom_cog,
          double kernel_m) const;
  std::optional<Pose> searchAlong(const StandingPoints& standing, const Pose& T_odom_cog_predicted,
                                  std::vector<bool>& has_vote) const;

  Params params_;
  NormalFilteredIcp::Params planes_;
  VoxelMap kept_;
  Pose T_odom_cog_kept_ = Pose::Identity();
  std::optional<double> kept_stamp_s_;  ///< of the sweep that was kept, or would have been
};

}  // namespace fail_aware
