// After a gap - sweeps that could not be registered - the prediction may be farther off than a nearest-point search
// reaches: in two seconds a bend begins, 20 deg and some metres. So the place is searched for first, seen from above
// (correlative_search.hpp), then the multiplex ICP from there, with correspondences that narrow, finds the start pose for
// the measurements (not in the paper). Where too little stands for that, the multiplex ICP alone, with wider seeds; then
// as much of the sweep has to fit as usual.
//
// Input as IcpPointToPoint::align's. Failure: nothing, if it does not converge or too little fits.
// Cost: 60 to 200 ms; only after a gap.
#pragma once

#include <optional>
#include <vector>

#include "fail_aware_lidar_odometry/core/registration/correlative_search.hpp"
#include "fail_aware_lidar_odometry/core/registration/icp_point_to_point.hpp"
#include "fail_aware_lidar_odometry/core/registration/registration_cloud.hpp"

namespace fail_aware {

class Relocalization {
 public:
  struct Params {
    bool enabled = true;
    double min_sigma_m = 0.1;  ///< predicted position sigma up to which the usual search is enough
    /// largest spread of the seeds: wider seeds would leave gaps between what correspondences reach
    double max_spread_m = 2.0;
    double max_distance_m = 1.5;  ///< cut-off of correspondences, not more than the voxels reach
    /// least ratio of inliers where no search confirmed the place: more than elsewhere (0.3)
    double min_inlier_ratio = 0.5;
    double narrow_m = 0.3;  ///< kernel at the end of the search: what fits better than this counts
    CorrelativeSearch::Params search;

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("enabled", self.enabled);
      v("search", self.search);
    }
    void validate() const;
  };

  /// Since the last sweep that is in the map.
  struct Gap {
    double duration_s = 0.0;
    double distance_m = 0.0;  ///< to the predicted position
  };

  /// `usual`: the multiplex ICP's, what is not widened is as there. Throws ParameterError.
  Relocalization(const Params& params, const IcpPointToPoint::Params& usual);

  /// `covariance`: of the predicted state (x, y, z, roll, pitch, yaw).
  bool isNeeded(const Matrix6d& covariance) const;
  std::optional<Pose> find(const RegistrationCloud& cloud, const VoxelMap& map, const Pose& T_odom_cog_predicted,
                           const Matrix6d& covariance, const Gap& gap) const;

  /// From one pose: how much of the sweep fits there tells one place from another. Not ok() below `min_inlier_ratio`.
  Measurement fit(const RegistrationCloud& cloud, const VoxelMap& map, const Pose& T_odom_cog,
                  const Matrix6d& covariance) const {
    return strict_.align(cloud.point_points_cog, map, T_odom_cog, covariance);
  }

 private:
  Params params_;
  CorrelativeSearch search_;
  IcpPointToPoint wide_, narrowing_, usual_, strict_;
};

}  // namespace fail_aware
