// What each beam of the head measures too far or too near, found while driving (not in the paper).
//
// A head's calibration leaves some centimetres of range error on each of its lasers, the same for months. The walls of
// the map become thick by it, and since a thing that comes nearer wanders from beam to beam, the way becomes too long or
// too short: by 1e-4 to 4e-4 with simulated heads. What the map's standing planes are missed by, beam by beam, tells how
// the beams differ; what all have in common is not sought. A Kalman filter a beam: its offset, measured by a sweep's
// mean distance over obliqueness. What varies slowly from beam to beam hardly shows, as the map errs alike: `forget`
// keeps it from drifting.
//
// Beams are told by the sweep's rings; without them nothing is known, and nothing corrected. The error is taken from
// the range as seen from the head's place at the stamp, some degrees from where it was when the beam was sent.
// Cost: one nearest plane a point, 0.5 ms a sweep.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/registration/icp_point_to_plane.hpp"

namespace fail_aware {

class BeamRangeBias {
 public:
  struct Params {
    bool enabled = true;
    double sigma_m = 0.03;  ///< initial sigma of a beam's offset: what a calibration of the head leaves
    /// its change from sweep to sweep: a wrong offset is corrected; heads hold theirs for months
    double walk_m = 0.002;
    double residual_m = 0.1;  ///< sigma of a point's distance from a plane: noise, roughness, common errors
    double kernel_m = 0.1;    ///< larger distances are something else
    /// ratio of the offset that is forgotten: keeps what varies slowly from beam to beam from drifting
    double forget = 0.05;
    /// least cosine between beam and normal: 45 deg; at more grazing angles the range hardly changes the distance
    double min_obliqueness = 0.7;
    /// largest z of the normal: upright planes only; ground is missed because of elevation errors, too
    double max_normal_z = 0.2;

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("enabled", self.enabled);
    }
    void validate() const;
  };

  /// `planes`: which pairs of point and plane, as there. Throws ParameterError.
  BeamRangeBias(const Params& params, const IcpPointToPlane::Params& planes);

  /// To be taken from each range, m, by ring; empty: nothing is known.
  const std::vector<float>& offsets_m() const { return offsets_m_; }

  /// A sweep, corrected by offsets_m(), at its estimate, before it joins the map. rings: one a point; from 256 on they
  /// are no beams.
  void observe(const std::vector<Eigen::Vector3f>& points_cog, const std::vector<std::uint16_t>& rings,
               const Eigen::Vector3d& lidar_in_cog, const VoxelMap& map, const Pose& T_odom_cog);

  void reset();

 private:
  Params params_;
  IcpPointToPlane::Params planes_;
  std::vector<float> offsets_m_;
  std::vector<double> variances_m2_;
};

}  // namespace fail_aware
