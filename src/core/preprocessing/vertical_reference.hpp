// Keeps the odometry level by what stands upright.
//
// The beams of a real head point a little off. Level road then looks bent; matched against a map that is bent alike
// it turns into a false pitch of the same sign on every metre: most of what lidar odometry drifts in height. The road
// cannot show it: ground curved by c, z = c h^2 / 2 at the horizontal distance h, and a pitch that drifts by -c a metre
// are the same to a matcher. But house walls, trunks and poles stand upright.
// Most of this drift comes from the error e that the elevations have in common (e > 0: the beams point higher than the
// head says). It makes level road a cone, z = -e h, on which pitch drifts by q e a metre; q depends on what is in view.
// The walls show e, and its correction ends most of the drift.
//
// From a sweep, every `look_every_m`, profiles are taken of what stands upright (upright_profiles.hpp). Their equations
// (profile_equations.hpp) hold the tilt (d_x, d_y) of odom's axes against gravity, the errors a_b of the beams' ranges,
// e that their elevations have in common, and j, what a single estimate is off by, another one at each look. Some
// centimetres of a_b lean a wall by a degree, so they are found along with the tilt: walls are straight, and are met by
// many beams at many distances. An extended Kalman filter over the distance s holds d, e, q, the other drift o and all
// a_b:
//   dd/ds = (q e + o - response bend) pitch axis + noise
// The pitch axis is horizontal, across the motion: how the sensor is turned on the vehicle does not matter.
// The elevations of the next sweeps are raised by what is found of e, and e in the state becomes what is left. A bend
// of the sweeps (z += bend h min(h, curvature_range) / 2) ends the rest of the drift, and slowly corrects the tilt:
//   response bend = q e + o + (d - d_0) . pitch axis / correction distance,  within max_curvature
// d_0 is the tilt of the first estimate in this odom: the slope and the mount at the start. It is in the state, so that
// what a later look shows of the beams corrects it, too. The map of the first sweeps is sparse, and with few beams the
// pose tilts by up to a degree within the first metres (new_map): d - d_0 holds it. The pose is never touched.
//
// Roll is measured likewise but not corrected. The tilt that is left, tiltMoment() = E[(d - d_0)(d - d_0)^T], becomes
// part of the odometry's covariance (estimation/vertical_drift.hpp).
//
// Failure is data: where nothing stands upright the sigmas grow as the walk says; what was found before is still
// corrected. Profiles off by more than their sigmas hardly count, and where they lean in all directions (hedges,
// banks), none does (lean_weights.hpp).
// Frames: points in the sensor's, tilt about odom's axes. Cost: apply 0.25 ms for 120 000 points, a look 5 ms; from 10
// m/s on each sweep has one.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/preprocessing/angle_corrections.hpp"
#include "core/preprocessing/profile_equations.hpp"

namespace fail_aware {

struct VerticalReferenceParams {
  bool enabled = true;
  double look_every_m = 1.0;    ///< distance between two searches for what stands upright
  double sigma_range_m = 0.03;  ///< initial sigma of the error of a beam's ranges: what a calibration leaves
  /// drift of pitch per error common to the elevations, and its sigma: on ten surrogate drives 0.013 to 0.046
  double drift_per_elevation_per_m = 0.033, sigma_drift_per_elevation_per_m = 0.015;
  double sigma_other_drift_deg_per_m = 0.001;  ///< initial sigma of the rest of the drift
  /// random walk of the rest of the drift: sigma after 1 m, grows with the root of the distance
  double drift_walk_deg_per_m = 4.5e-5;
  double tilt_walk_deg = 0.005;  ///< random walk of the tilt, in addition to the drift, likewise
  /// sigma of the tilt that the sparse map of the first metres adds with 16 beams; goes down with the square of their
  /// number
  double new_map_tilt_deg = 0.5;
  double new_map_m = 12.0;       ///< distance over which it does
  double jitter_deg = 0.08;      ///< sigma of the error of tilt of a single estimate
  double range_walk_m = 0.0002;  ///< random walk of the errors of the ranges, likewise
  /// neighbouring searches see the same things: factor on the variance
  double correlation_inflation = 2.5;
  /// response of pitch to a bend, as a ratio of what ground alone would give: walls hold the pitch
  double response = 0.66;
  /// largest bend of a sweep: above the expected drift, so that a wrong estimate has a small effect
  double max_curvature_deg_per_m = 0.035;
  /// beyond this range the bend continues as a straight line: little ground is seen there
  double curvature_range_m = 40.0;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("enabled", self.enabled);
  }
};

class VerticalReference {
 public:
  using Params = VerticalReferenceParams;

  struct Report {
    std::size_t looks = 0;
    double tilt_deg = 0.0;  ///< of pitch, since the start of this odom
    double tilt_sigma_deg = 0.0;
    double drift_deg_per_m = 0.0;  ///< of pitch, for sweeps that are raised but not bent
    double drift_sigma_deg_per_m = 0.0;
    double elevation_deg = 0.0;  ///< e of the sweeps that apply() is given
    double elevation_sigma_deg = 0.0;
    double curvature_deg_per_m = 0.0;
  };

  /// sigma_elevation_deg: initial sigma of the error that the elevations have in common.
  explicit VerticalReference(const Params& params,
                             double sigma_elevation_deg = VerticalAngleCorrectionParams().sigma_deg);

  /// Raises and bends a sweep's points (m, sensor frame), which come corrected by the sensor's parameters.
  void apply(std::vector<Eigen::Vector3f>& points_lidar) const;

  /// Learns from a sweep that was given to apply() and then corrected for motion. Every sweep, in order. rings: one a
  /// point, or empty: found from the elevations.
  /// `odom_reset_count`: another one than the last sweep's is another odom (SweepPrediction's); what was known of the
  /// tilt about the last one's axes ends, what the sensor does (drift, errors of the beams) stays.
  void observe(const std::vector<Eigen::Vector3f>& points_lidar, const std::vector<std::uint16_t>& rings,
               const Pose& T_odom_lidar, int odom_reset_count = 0);

  const Report& report() const { return report_; }

  /// Mean square error of the estimate's tilt about odom's axes x and y (rad^2), which were level at the start: what is
  /// not corrected yet, and how well that is known. Grows where nothing stands upright; 0 before the first sweep.
  const Eigen::Matrix2d& tiltMoment() const { return tilt_moment_; }

  void reset();

 private:
  void forgetOdom();
  double advance(const Pose& T_odom_lidar);
  void move(const Eigen::Vector2d& turned);
  void beginLook();
  void resizeBeams();
  void update();
  double drift() const;
  Eigen::VectorXd driftGradient() const;
  void setRaise(double distance_m);
  void setBend();

  Params params_;
  double sigma_elevation_rad_;
  UprightProfileFinder finder_;
  std::vector<BeamRange> ranges_;  ///< as given to the finder
  Report report_;
  Eigen::VectorXd x_;  ///< VerticalState
  Eigen::MatrixXd P_;
  Eigen::Matrix2d tilt_moment_ = Eigen::Matrix2d::Zero();
  struct {
    double raise_rad = 0.0, curvature_per_m = 0.0;
  } correction_;                                          ///< of the next sweep
  std::optional<Eigen::Vector3d> last_position_odom_;     ///< counted last
  Eigen::Vector2d pitch_axis_ = Eigen::Vector2d::Zero();  ///< across the motion, to the left of it
  double since_look_m_ = 0.0, since_start_m_ = 0.0;
  std::size_t beams_ = 0;  ///< of the head, from the rings; 0: not known
  int odom_reset_count_ = 0;
};

}  // namespace fail_aware
