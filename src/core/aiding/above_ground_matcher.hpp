// Where the vehicle is by what stands around it, for open country (not in the paper).
//
// In a field nearly all surfaces are ground, and ground misleads: its scan lines travel with the sensor, and a map of
// sweeps that were placed at a wrong speed fits the next one at the same wrong speed. A few bushes and posts fit the
// right speed only, but are outnumbered. In open country horizontal position and heading are therefore taken from the
// standing points alone (above_ground_points.hpp). They are matched with those of one sweep that is kept for some
// metres (above_ground_reference.hpp), one vote per place: a search along the path, then Gauss-Newton over x, y and
// heading. Open country is where planes observe both horizontal directions poorly (`max_information_ratio`) and few
// points stand (`max_above_ground_ratio`). A motorway is none: its rails observe the direction across.
//
// The match allows for the near sides that move around what stands while the vehicle passes (near_side.hpp).
//
// A place that fits everywhere nearly as well as at its best (a fence along the road) has no vote. What keeps its
// distance ahead is outside of the window, which is at most half of the distance driven since the sweep was kept (at
// least 0.4 m).
//
// Frames: points of the centre of gravity; poses odom. Failure: nothing. Cost: the planes' equations once, of some of
// the points (0.6 ms); in open country 1 to 2 ms more.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/map/above_ground_points.hpp"
#include "core/map/above_ground_reference.hpp"
#include "core/map/voxel_map.hpp"
#include "core/registration/icp_point_to_plane.hpp"

namespace fail_aware {

struct AboveGroundPose {
  Pose T_odom_cog;             ///< roll and pitch as predicted, z too, except for the motion along the vehicle's axis
  Eigen::Matrix3d covariance;  ///< x, y, m, and yaw, rad, odom's axes
};

class AboveGroundMatcher {
 public:
  struct Params {
    AboveGroundReference::Params reference;  ///< `enabled`: of the matcher, too
    /// used up to this information of the planes' strongest horizontal direction: 8 fields have 0.01 to 0.14 in 95 % of
    /// the sweeps, four country roads 0.2 to 0.55, four highways 0.4 to 0.85
    double max_information_ratio = 0.2;
    double surface_sigma_m = 0.3;    ///< sigma there of the horizontal position from surfaces
    double surface_sigma_deg = 0.2;  ///< likewise of the heading
    /// searched along the road, to both sides of the prediction: a speed that is wrong by 10 m/s at 10 Hz
    double window_m = 1.0;
    double step_m = 0.2;      ///< step of that search: as kernel_m
    double kernel_m = 0.2;    ///< Geman-McClure scale at the end
    double contrast_m = 0.6;  ///< the votes are compared this far beyond the window
    /// least difference of a place's best and worst vote: a fence along the road has less
    double min_contrast = 0.3;
    double sigma_m = 0.10;    ///< sigma of one place: scatter of a bush's points from sweep to sweep
    double min_places = 1.7;  ///< fewer places give no result: one place gives no heading

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("enabled", self.reference.enabled);
    }
  };

  /// `planes`: which pairs count, and how much.
  AboveGroundMatcher(const Params& params, const IcpPointToPlane::Params& planes) : params_(params), planes_(planes) {}

  /// The ratio of their information that the planes hold of the strongest horizontal direction; 0 without planes.
  double ratioOfPlanes(const std::vector<Eigen::Vector3f>& points_cog, const VoxelMap& map,
                       const Pose& T_odom_cog_predicted, double sigma_yaw_rad) const;

  /// What stands within range, less the distance that a kept sweep may lie behind.
  AboveGroundPoints select(const std::vector<Eigen::Vector3f>& points_cog) const;

  std::optional<AboveGroundPose> find(const AboveGroundPoints& above_ground_cog, const AboveGroundReference& reference,
                                      const Pose& T_odom_cog_predicted) const;

  const Params& params() const { return params_; }

 private:
  Params params_;
  IcpPointToPlane::Params planes_;
};

}  // namespace fail_aware
