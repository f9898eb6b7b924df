// Finds the vehicle in the map after a gap (sweeps that could not be registered). Not in the paper.
//
// After a gap the prediction may be farther off than a nearest-point search reaches: if a bend begins, two seconds
// cause 20 deg and some metres. A search seen from above (correlative_search.hpp) gives a pose; the multiplex ICP
// starts there, with narrowing correspondences, and gives the start pose of the measurements. If too few points are
// above the ground for the search, the multiplex ICP runs alone with wider seeds; then `min_inlier_ratio` of the points
// must fit, as in a usual sweep.
//
// Input: that of IcpPointToPoint::align.
// Failure: nullopt, if it does not converge or too few points fit. Cost: 60 to 200 ms; only after a gap.
#pragma once

#include <optional>

#include "core/initial_guess/correlative_search.hpp"
#include "core/preprocessing/registration_cloud.hpp"
#include "core/registration/icp_point_to_point.hpp"

namespace fail_aware {

class Relocalization {
 public:
  struct Params {
    bool enabled = true;
    double min_sigma_m = 0.1;  ///< horizontal sigma of the prediction up to which the usual seeds are enough
    /// largest spread of the seeds: wider seeds would leave gaps between the ranges of their correspondences
    double max_spread_m = 2.0;
    double max_distance_m = 1.5;  ///< cut-off of correspondences, at most the reach of the voxels
    /// least inlier ratio where no search confirmed the pose: higher than elsewhere (0.3)
    double min_inlier_ratio = 0.5;
    double narrow_m = 0.3;  ///< kernel at the end of the search: points that fit better than this count
    CorrelativeSearchParams search;

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("enabled", self.enabled);
      v("search", self.search);
    }
  };

  /// Since the last inserted sweep.
  struct Gap {
    double duration_s = 0.0;
    double distance_m = 0.0;  ///< to the predicted position
  };

  /// `usual`: parameters of the multiplex ICP; used where no wider value applies.
  Relocalization(const Params& params, const IcpPointToPoint::Params& usual);

  /// `covariance`: of the predicted pose (SweepPrediction::covariance).
  bool isNeeded(const Matrix6d& covariance) const;
  std::optional<Pose> find(const RegistrationCloud& cloud, const VoxelMap& map, const Pose& T_odom_cog_predicted,
                           const Matrix6d& covariance, const Gap& gap) const;

  /// Registers from one pose; the inlier ratio distinguishes the poses. Not ok() below `min_inlier_ratio`.
  Measurement fit(const RegistrationCloud& cloud, const VoxelMap& map, const Pose& T_odom_cog,
                  const Matrix6d& covariance) const {
    return strict_.align(cloud.point_points_cog, map, T_odom_cog, covariance);
  }

 private:
  Params params_;
  IcpPointToPoint wide_, narrowing_, usual_, strict_;
};

}  // namespace fail_aware
