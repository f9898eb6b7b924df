// After a gap - sweeps that could not be registered - the prediction may be farther off than a nearest-point search
// reaches. The multiplex ICP once more, with wider seeds and correspondences that narrow, finds the start pose for the
// measurements (not in the paper). What it finds counts if as much of the sweep fits there as usual.
//
// Input as MultiplexIcp::align's. Failure: nothing, if it does not converge or too little fits; the prediction has to
// do.
// Cost: that of some eight registrations; only after a gap.
#pragma once

#include <optional>
#include <vector>

#include "fail_aware_lidar_odometry/core/registration/multiplex_icp.hpp"

namespace fail_aware {

class Relocalization {
 public:
  struct Params {
    bool enabled = true;
    double min_sigma_m = 0.1;       ///< of the predicted position; below it the usual search reaches
    double max_spread_m = 2.0;      ///< of the seeds, at most
    double max_distance_m = 1.5;    ///< cut-off of correspondences, no more than voxels reach
    double min_inlier_share = 0.5;  ///< of the sweep, within the usual distance
    double narrow_m = 0.3;          ///< the kernel that ends the search: what fits by less counts

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("enabled", self.enabled);
      v("min_sigma_m", self.min_sigma_m);
      v("max_spread_m", self.max_spread_m);
      v("max_distance_m", self.max_distance_m);
      v("min_inlier_share", self.min_inlier_share);
      v("narrow_m", self.narrow_m);
    }
    void validate() const;
  };

  /// `usual`: the multiplex ICP's, what is not widened is as there. Throws ParameterError.
  Relocalization(const Params& params, const MultiplexIcp::Params& usual);

  /// `covariance`: of the predicted state (x, y, z, roll, pitch, yaw).
  bool isNeeded(const Matrix6d& covariance) const;
  std::optional<Pose> find(const std::vector<Eigen::Vector3f>& points_cog, const VoxelMap& map,
                           const Pose& T_odom_cog_predicted, const Matrix6d& covariance) const;

 private:
  Params params_;
  MultiplexIcp wide_, usual_;
};

}  // namespace fail_aware
