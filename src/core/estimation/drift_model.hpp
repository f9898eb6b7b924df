// Which part of a sweep's uncertainty stays in the odometry for good (not in the paper).
//
// A sweep is registered against a map, so most of a measurement's error is gone with the next sweep: the pose jitters
// about the map, the jitter does not add up. What adds up is the error of the map around the vehicle
// (odometry_covariance.hpp), which the sweeps replace as the vehicle drives on, within `map_length_m`:
//   - by the pose's error, as far as the registration does not take it back
//   - by an error of the registrations that its sweeps have in common: `registration_ratio` of their variance
//   - by a slow drift: a random walk in position, tilt and heading, per square root of a metre
//   - biases, from a sensor whose beams are off by the same every sweep: a heading error per metre and a scale error.
//     Unknown and constant; they make the error grow with distance squared and distance. Each head has its own (0.1 to
//     0.5 m per km of scale in ten simulated ones), so that one head's errors are alike on all its drives.
//   - what a new map costs: it holds the points of one sweep, between whose beams the pose settles 1 to 4 cm off within
//     the first 0.1 m (five simulated standing starts), and tilted by 0.1 to 0.25 deg (moving starts)
//
// The jitter at t1 stays: a heading that is off by 0.01 deg there moves the position by 7 cm in 400 m. Over 0.5 s the
// poses of 79 drives (town to open field, 64 beams) jitter by 0.7 of the registration's standard deviation in heading
// and by 0.5 of it in position, rms; single drives by 0.3 to 1.2. transient_ratio and transient_rotation_ratio are
// these, squared.
//
// calibrate_noise fits registration_ratio, position_ and heading_per_root_metre, heading_bias and scale_bias; map
// length, tilt and new_map_m are chosen by hand.
//
// Units m, rad unless the name says otherwise; covariances about the previous body's axes. Cost: negligible.
#pragma once

#include "core/geometry/pose.hpp"
#include "core/parameters/check.hpp"

namespace fail_aware {

struct DriftModel {
  double map_length_m = 65.0;       ///< distance over which the map around the vehicle is replaced; 0: with each sweep
  double registration_ratio = 0.3;  ///< of a registration's variance: what a map's worth of sweeps has in common
  double position_per_root_metre_m = 0.0;
  double tilt_per_root_metre_deg = 0.0065;
  double heading_per_root_metre_deg = 0.0003;
  double heading_bias_deg_per_m = 0.00002;  ///< standard deviation of the constant
  double scale_bias = 0.0001;               ///< likewise: metres per metre
  double transient_ratio = 0.25;  ///< of a registration's variance: the jitter of the pose about the map: position
  double transient_rotation_ratio = 0.5;  ///< likewise rotation
  double new_map_m = 0.02;                ///< standard deviation that the first 0.1 m in a new map add; tilt: 0.1 deg

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("map_length_m", self.map_length_m, within(0.0, kLargestParameter));
    v("registration_ratio", self.registration_ratio, within(0.0, kLargestParameter));
    v("position_per_root_metre_m", self.position_per_root_metre_m, requireNotNegative);
    v("tilt_per_root_metre_deg", self.tilt_per_root_metre_deg, requireNotNegative);
    v("heading_per_root_metre_deg", self.heading_per_root_metre_deg, requireNotNegative);
    v("heading_bias_deg_per_m", self.heading_bias_deg_per_m, requireNotNegative);
    v("scale_bias", self.scale_bias, requireNotNegative);
    v("transient_ratio", self.transient_ratio, within(0.0, 1e6));
    v("transient_rotation_ratio", self.transient_rotation_ratio, within(0.0, 1e6));
    v("new_map_m", self.new_map_m, requireNotNegative);
  }

  /// Variances that the distance of one sweep adds to the pose and to the map alike.
  Vector6d walkVariances(double distance_m) const;
  /// Ratio of the map around the vehicle that one sweep replaces, 0..1. A sweep that sees less far than usual is compared
  /// with a shorter map. view_range_m 0: not known.
  double mapReplaced(double distance_m, double view_range_m = 0.0) const;
  /// The pose's jitter about the map. `registration`: what a sweep's registration adds to the pose's covariance.
  Matrix6d transient(const Matrix6d& registration) const;

  /// Variances of position and tilt that the distance from `from_m` to `to_m`, counted from where the map begins, adds
  /// for good.
  Vector6d newMapVariances(double from_m, double to_m) const;

  /// Variances of the two constants: heading (rad^2/m^2) and scale.
  Eigen::Vector2d biasVariances() const;
};

}  // namespace fail_aware
