// Deskew refinement: the turn rate during the sweep, from the sweep itself (not in the paper).
//
// A sweep is deskewed for the predicted motion. At the start of a turn the predicted rate is wrong by some degrees per
// second: walls seen early in the sweep are rotated against walls seen late, and registration settles in between. The
// refinement registers the sweep point to plane with free pose and free turn rate; the prediction is the prior of the
// rate. The registered pose is discarded. A compensated sweep was deskewed by an unknown motion; its remaining turn
// rate is found in the same way, with zero rate as prior.
//
// Rates: rad/s about the axes of the centre of gravity, to be added to the motion that the sweep was deskewed for;
// points measured at the sweep's middle do not move.
// Failure: nullopt, without times, planes or convergence, of part of a revolution, and for a rate that no vehicle has.
// Cost: one point-to-plane registration.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/registration/icp_point_to_plane.hpp"

namespace fail_aware {

class DeskewRefinement {
 public:
  struct Params {
    bool enabled = true;
    /// sigma of the predicted turn rate, per axis (compensated sweep: of zero rate); at the start of a turn the
    /// prediction is wrong by some degrees per second
    double sigma_deg_s = 4.0;

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("enabled", self.enabled);
    }
  };

  /// `planes`: pairs, weights and iterations are taken from it.
  DeskewRefinement(const Params& params, const IcpPointToPlane::Params& planes) : params_(params), planes_(planes) {}

  /// times_s: one per point, relative to the stamp; middle_s: likewise.
  std::optional<Eigen::Vector3d> find(const std::vector<Eigen::Vector3f>& points_cog, const std::vector<float>& times_s,
                                      double middle_s, const VoxelMap& map, const Pose& T_odom_cog_predicted,
                                      double sigma_yaw_rad) const;

 private:
  Params params_;
  IcpPointToPlane::Params planes_;
};

}  // namespace fail_aware
