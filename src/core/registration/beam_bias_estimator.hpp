// What each beam of the head measures too far and how much too high it points, found while driving (not in the paper).
//
// A head's calibration leaves some centimetres of range error and a tenth of a degree of elevation error on each of its
// lasers, the same for months.
// Range: the walls of the map become thick by it, and since a thing that comes nearer wanders from beam to beam, the
// distance becomes too long or too short: by 1e-4 to 4e-4 with simulated heads. Found from the map's upright planes.
// Elevation: each beam meets flat ground at one distance, so its error is a ring of false height that travels with the
// vehicle, and the pose's pitch and roll wander by it. The beams about the horizon meet banks, hedges and roofs
// instead; a false height on a bank is a false distance to the side, and the heading wanders by it. Found from all
// planes that are not upright.
//
// What the planes are missed by, beam by beam, shows how the beams differ (beam_offsets.hpp). Of the ranges the common
// part is not sought. Of the elevations all that varies smoothly with the distance on the ground is not sought: a
// common error, a false height of the lidar, a bend of the road; vertical_reference.hpp finds these from what stands
// upright.
//
// A sweep without rings is not corrected: its beams cannot be distinguished. The corrections use the head's pose at the
// stamp, which differs by some degrees from its pose when the beam was sent.
// Cost: one nearest plane a point, 0.5 ms a sweep.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/registration/beam_offsets.hpp"
#include "core/registration/icp_point_to_plane.hpp"
#include "core/types/beam_bias.hpp"

namespace fail_aware {

class BeamBiasEstimator {
 public:
  struct Params {
    bool enabled = true;
    BeamOffsets::Params range_m = {0.03, 0.002, 0.1, 0.05, 0.2};
    /// 0.15 deg; per sweep 0.002 deg; at most 1 deg
    BeamOffsets::Params elevation_rad = {2.6e-3, 3.5e-5, 0.1, 0.05, 0.0175};
    double kernel_m = 0.1;  ///< larger distances are something else
    /// least cosine between beam and normal of a wall: 45 deg; at more grazing angles the range hardly changes the
    /// distance
    double min_obliqueness = 0.7;
    double max_wall_normal_z = 0.2;  ///< upright planes

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("enabled", self.enabled);
    }
  };

  /// `planes`: which pairs of point and plane, as there.
  BeamBiasEstimator(const Params& params, const IcpPointToPlane::Params& planes);

  BeamBias bias() const { return {ranges_m_.values(), elevations_rad_.values()}; }

  /// A sweep, corrected by bias(), at its estimate, before it joins the map. rings: one a point; from 256 on they are
  /// no beams.
  void observe(const std::vector<Eigen::Vector3f>& points_cog, const std::vector<std::uint16_t>& rings,
               const Pose& T_cog_lidar, const VoxelMap& map, const Pose& T_odom_cog);

  void reset() {
    ranges_m_.reset();
    elevations_rad_.reset();
  }

 private:
  Params params_;
  IcpPointToPlane::Params planes_;
  BeamOffsets ranges_m_, elevations_rad_;
};

}  // namespace fail_aware
