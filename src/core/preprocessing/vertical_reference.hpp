// Keeps the odometry level by what stands upright.
//
// The beams of a real head point a little off. Level road then looks bent; matched against a map that is bent alike
// it turns into a false pitch of the same sign on every metre: most of what lidar odometry drifts in height. The road
// cannot tell: ground curved by c, z = c h^2 / 2 at the horizontal distance h, and a pitch that drifts by -c a metre
// are the same to a matcher. But house walls, trunks and poles stand upright.
//
// From a sweep, every `look_every_m`, profiles are taken of what stands upright (upright_profiles.hpp): by beam b, the
// mean offset o_b along a horizontal direction m, at the height z_b. In odom, tilted by (d_x, d_y) against gravity,
//   o_b = const + z_b ((d_y + j_y) m_x - (d_x + j_x) m_y + e (m . away)) + g_b a_b + noise,   g_b = m . (direction of sight)
// a_b is the error of the beam's ranges, e what the elevations of all beams have in common (it leans everything towards
// the sensor or away from it, on all sides; a tilt leans one side towards and the other away). Some centimetres of a_b
// lean a wall by a degree, so they are found along with the tilt: walls are straight, and are met by many beams at many
// distances. j is what a single estimate is off by, another one at each look. A Kalman filter over the way s holds d, the
// drift of pitch, e and all a_b:
//   dd/ds = (drift - response bend) lateral axis + noise
// The constant of each profile is unknown and is eliminated. The less straight a profile is, the less its lean counts.
// Sweeps are bent by `bend` (z += bend h min(h, curvature_range) / 2) so that the drift ends and what has come of it slowly
// goes: response bend = drift + tilt_gain (d - d_kept) . lateral axis, within max_curvature; d_kept is the tilt when it was
// first known. The pose is never touched.
//
// Failure is data: where nothing stands upright the sigmas grow as the walk says, and the bend stays where it was.
// Profiles off by more than their sigmas hardly count; when most are, the tilt is let go and found anew.
// Frames: points in the sensor's, tilt about odom's axes. Cost: apply 0.1 ms for 120 000 points, a look 5 ms.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/preprocessing/upright_profiles.hpp"

namespace fail_aware {

struct VerticalReferenceParams {
  bool enabled = true;
  double look_every_m = 3.0;  ///< distance between two searches for what stands upright
  UprightProfilesParams profiles;
  /// sigma of the true lean of walls, of trunks and poles, and of the latter towards the sensor: those of what people
  /// build, in addition to the standard error
  double sigma_surface_deg = 0.1;
  double sigma_line_deg = 0.3;
  double sigma_line_away_deg = 0.5;
  double point_sigma_m = 0.015;  ///< sigma of a point's offset
  double beam_sigma_m = 0.003;   ///< sigma of a beam's mean offset, in addition
  double line_sigma_m = 0.006;   ///< the same for trunks and poles: their edges fall between two columns of the head
  double sigma_range_m = 0.03;   ///< initial sigma of the error of a beam's ranges: what a calibration leaves
  double sigma_elevation_deg = 0.15;  ///< initial sigma of the error that the beams' elevations have in common
  /// initial sigma of the drift of pitch: the order of what errors of the beams cause
  double sigma_drift_deg_per_m = 0.005;
  /// random walk of the drift: sigma after 1 m, grows with the root of the distance
  double drift_walk_deg_per_m = 4.5e-5;
  double tilt_walk_deg = 0.005;  ///< random walk of the tilt, in addition to the drift, likewise
  double jitter_deg = 0.08;      ///< sigma of the error of tilt of a single estimate
  double range_walk_m = 0.0002;  ///< random walk of the errors of the ranges, likewise
  /// neighbouring searches see the same things: factor on the variance
  double correlation_inflation = 2.5;
  /// response of pitch to a bend, as a ratio of what ground alone would give: walls hold the pitch
  double response = 0.66;
  /// ratio of the tilt since it was known that is corrected per metre: gone after some 20 m
  double tilt_gain_per_m = 0.05;
  /// largest bend of a sweep: above the expected drift, so that a wrong estimate has a small effect
  double max_curvature_deg_per_m = 0.02;
  /// beyond this range the bend continues as a straight line: little ground is seen there
  double curvature_range_m = 40.0;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("enabled", self.enabled);
  }
  void validate() const;
};

class VerticalReference {
 public:
  using Params = VerticalReferenceParams;

  struct Report {
    std::size_t looks = 0;
    std::size_t surfaces = 0;  ///< in the last look
    std::size_t lines = 0;
    double tilt_deg = 0.0;  ///< of pitch, since it was known in this odom
    double tilt_sigma_deg = 0.0;
    double drift_deg_per_m = 0.0;  ///< of pitch, if nothing were bent
    double drift_sigma_deg_per_m = 0.0;
    double elevation_deg = 0.0;  ///< error that the elevations of the beams have in common
    double curvature_deg_per_m = 0.0;
  };

  VerticalReference() : VerticalReference(Params()) {}
  explicit VerticalReference(const Params& params);

  /// Bends a raw sweep's points (m, sensor frame).
  void apply(std::vector<Eigen::Vector3f>& points_lidar) const;

  /// Learns from a sweep that was given to apply() and then corrected for motion. Every sweep, in order. rings: one a
  /// point, or empty: told by the elevations.
  /// `odom_reset_count`: another one than the last sweep's is another odom (SweepPrediction's); what was known of the tilt
  /// about the last one's axes ends, what the sensor does (drift, errors of the beams) stays.
  void observe(const std::vector<Eigen::Vector3f>& points_lidar, const std::vector<std::uint16_t>& rings,
               const Pose& T_odom_lidar, int odom_reset_count = 0);

  const Report& report() const { return report_; }

  /// Everything anew.
  void reset();

 private:
  struct Equations;  ///< of one profile

  void forgetOdom();
  void advance(const Pose& T_odom_lidar);
  void beginLook();
  void resizeBeams();
  Equations equationsOf(const UprightProfile& profile) const;
  void update();
  void setBend(const Pose& T_odom_lidar);

  Params params_;
  UprightProfileFinder finder_;
  std::optional<Eigen::Vector2d> kept_tilt_;
  std::vector<BeamRange> ranges_;  ///< as given to the finder
  Report report_;
  Eigen::VectorXd x_;  ///< tilt x y, drift, elevation, jitter x y, range by beam
  Eigen::MatrixXd P_;
  double curvature_per_m_ = 0.0;  ///< rad
  bool has_position_ = false;
  Eigen::Vector3d last_position_odom_ = Eigen::Vector3d::Zero();
  double since_look_m_ = 0.0;
  int odom_reset_count_ = 0;
};

}  // namespace fail_aware
