// How the vehicle turned while the head swept, from the sweep itself (not in the paper).
//
// A sweep is corrected for the motion that the filter predicts. Where a turn begins, that rate is wrong by some degrees
// a second: the walls seen early in the sweep are turned against those seen late, and registration settles between
// them. So the sweep is registered point to plane with pose and turn rate free, the rate with the prediction as prior;
// the registered pose is thrown away. A sweep that came compensated was moved by somebody else's motion; what is left in it
// is found likewise, with no turn as prior.
//
// Rates: rad/s about the axes of the centre of gravity, what is to be added to the motion that the sweep was corrected
// for; what was measured at the sweep's middle stays where it is.
// Failure: nothing, without times, planes or convergence. Cost: a point-to-plane registration.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "fail_aware_lidar_odometry/core/registration/icp_point_to_plane.hpp"

namespace fail_aware {

class DeskewRefinement {
 public:
  struct Params {
    bool enabled = true;
    /// sigma of the predicted turn rate, each axis (a compensated cloud: of no turn); at the start of a turn the
    /// prediction is off by some degrees a second
    double sigma_deg_s = 4.0;

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("enabled", self.enabled);
    }
    void validate() const;
  };

  /// `planes`: pairs, weights and iterations as there. Throws ParameterError.
  DeskewRefinement(const Params& params, const IcpPointToPlane::Params& planes);

  /// times_s: one a point, relative to the stamp, as middle_s.
  std::optional<Eigen::Vector3d> find(const std::vector<Eigen::Vector3f>& points_cog, const std::vector<float>& times_s,
                                      double middle_s, const VoxelMap& map, const Pose& T_odom_cog_predicted,
                                      double sigma_yaw_rad) const;

 private:
  Params params_;
  IcpPointToPlane::Params planes_;
};

}  // namespace fail_aware
