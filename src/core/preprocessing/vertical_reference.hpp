// Keeps the odometry level by what stands upright.
//
// The beams of a real head point a little off. Level road then looks bent; matched against a map that is bent alike
// it turns into a false pitch of the same sign on every metre: most of what lidar odometry drifts in height. The road
// cannot tell: ground curved by c, z = c h^2 / 2 at the horizontal distance h, and a pitch that drifts by -c a metre
// are the same to a matcher. But house walls, trunks and poles stand upright; elevation errors do not lean them over.
//
// From a sweep, every `look_every_m`, columns are taken: a wall's normal n, a trunk's direction u. In odom, tilted by
// (d_x, d_y) against gravity,
//   n_z = d_x n_y - d_y n_x + lean(r),   u_xy = (d_y, -d_x) + lean(r) e,   e: away from the sensor
// where lean(r), of whatever is at range r, comes of the beams' range errors. How far a column's lean can be trusted is
// its standard error: thickness over height, by the number of beams that hit it. A Kalman filter over the way s holds
// d, its value at the start, the drift of pitch, the leans, and what leans alike at one place and is another
// `place_length_m` on (without it many columns that err together would be believed too much):
//   dd/ds = (drift - response bend) lateral axis + noise
// Sweeps are bent by `bend` (z += bend h min(h, curvature_range) / 2) so that the drift ends and what has come of it slowly
// goes: response bend = drift_gain drift + tilt_gain (d - d_start) . lateral axis, within max_curvature. The pose is never
// touched.
//
// Failure is data: where nothing stands upright the sigmas stay as large as the priors, and the bend where it was.
// Columns off by more than their sigmas hardly count; when most are, the tilt is let go and found anew.
// Frames: points in the sensor's, tilt about odom's axes. Cost: apply 0.1 ms for 120 000 points, a look 1.5 ms.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry/pose.hpp"

namespace fail_aware {

struct LevelKeepingParams {
  bool enabled = true;
  /// distance between two searches for walls, trunks and poles: two searches in each place (place_length_m)
  double look_every_m = 3.0;
  double column_m = 1.0;  ///< side of a column: holds a trunk, and little besides one wall
  /// nearest points used, from the sensor: nearer ones may be parts of the vehicle or its load
  double min_range_m = 4.0;
  double max_range_m = 30.0;   ///< farthest points used: farther columns are hit by too few beams
  double min_height_m = -1.2;  ///< lowest point of a column, above the sensor; the ground must be below it
  /// highest point of a column, above the sensor: higher up are crowns of trees and eaves
  double max_height_m = 3.0;
  int min_points = 12;  ///< fewest points of a column: fewer give no direction
  /// least height from a column's lowest to its highest point: lower things need not stand upright
  double min_extent_m = 0.7;
  double beam_step_deg = 0.4;  ///< beams that are nearer to each other count as one: about an HDL-64E's spacing
  double max_standard_error_deg = 3.0;  ///< surfaces with a larger standard error of the lean are not used
  /// sigma of the true lean of surfaces, in addition to the standard error: walls are plumb
  double sigma_surface_deg = 0.05;
  double sigma_line_deg = 1.0;   ///< the same for trunks and poles, towards the sensor, from range errors
  double sigma_lean_deg = 1.0;   ///< sigma of the apparent lean at one range
  double sigma_place_deg = 0.3;  ///< sigma of the lean that all surfaces at one place have in common
  double place_length_m = 6.0;   ///< length of a place along the road
  /// initial sigma of the drift of pitch: the order of what errors of the beams cause
  double sigma_drift_deg_per_m = 0.005;
  /// random walk of the drift: sigma after 1 m, grows with the root of the distance; errors of the beams hardly
  /// change during a drive
  double drift_walk_deg_per_m = 4.5e-5;
  double tilt_walk_deg = 0.02;  ///< random walk of the tilt, in addition to the drift, likewise
  /// neighbouring searches see the same columns: factor on the variance; they count as half as many
  double correlation_inflation = 2.0;
  /// response of pitch to a bend, as a ratio of what ground alone would give: walls hold the pitch
  double response = 0.66;
  /// ratio of the tilt since the start that is corrected per metre: gone after some 25 m
  double tilt_gain_per_m = 0.04;
  double drift_gain = 1.0;  ///< ratio of the drift that is corrected; 1: all of it
  /// largest bend of a sweep: above the expected drift, so that a wrong estimate has a small effect
  double max_curvature_deg_per_m = 0.008;
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
  using Params = LevelKeepingParams;

  struct Report {
    std::size_t looks = 0;
    std::size_t surfaces = 0;  ///< in the last look
    std::size_t lines = 0;
    double tilt_deg = 0.0;  ///< of pitch, since the start or since odom is another one
    double tilt_sigma_deg = 0.0;
    double drift_deg_per_m = 0.0;  ///< of pitch, if nothing were bent
    double drift_sigma_deg_per_m = 0.0;
    double curvature_deg_per_m = 0.0;
  };

  VerticalReference() : VerticalReference(Params()) {}
  explicit VerticalReference(const Params& params);

  /// Bends a raw sweep's points (m, sensor frame).
  void apply(std::vector<Eigen::Vector3f>& points_lidar) const;

  /// Learns from a sweep that was given to apply() and then corrected for motion. Every sweep, in order.
  /// `odom_reset_count`: another one than the last sweep's is another odom (SweepPrediction's); what was known of the tilt
  /// about the last one's axes ends, what the sensor does (drift, leans by range) stays.
  void observe(const std::vector<Eigen::Vector3f>& points_lidar, const Pose& T_odom_lidar, int odom_reset_count = 0);

  const Report& report() const { return report_; }

  /// Everything anew.
  void reset();

 private:
  static constexpr int kRanges = 5;
  static constexpr int kPlace = 5 + kRanges;
  static constexpr int kStates = kPlace + 2;  ///< tilt x y, drift, tilt x y at the start, leans by range, of the place
  using State = Eigen::Matrix<double, kStates, 1>;
  using Covariance = Eigen::Matrix<double, kStates, kStates>;

  struct Column {
    float n = 0.0f;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    float xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
    float low = 0.0f, high = 0.0f;
    std::uint64_t beams = 0;  ///< a bit an elevation
  };
  struct Upright {  ///< one scalar equation: value = row . state
    double value;
    double sigma;
    Eigen::Vector2d tilt;
    double lean;
    int range;
  };

  void forgetOdom();
  void advance(const Pose& T_odom_lidar);
  void fillColumns(const std::vector<Eigen::Vector3f>& points_lidar, const Eigen::Matrix3f& R_odom_lidar);
  void findUprights();
  void update();
  void setBend(const Pose& T_odom_lidar);

  Params params_;
  Report report_;
  State x_;
  Covariance P_;
  double curvature_per_m_ = 0.0;  ///< rad
  int cells_;                     ///< columns along a side of the grid
  std::vector<Column> columns_;
  std::vector<Upright> uprights_;
  bool has_position_ = false;
  Eigen::Vector3d last_position_odom_ = Eigen::Vector3d::Zero();
  double since_look_m_ = 0.0;
  int odom_reset_count_ = 0;
};

}  // namespace fail_aware
