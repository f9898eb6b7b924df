// Which part of a sweep's uncertainty stays in the odometry for good (not in the paper).
//
// A sweep is registered against a map, so most of a measurement's error is gone with the next sweep: the pose jitters
// about the map, the jitter does not add up. What adds up is
//   - what the measurements leave open: FilterState::unobserved_covariance (types/filter_state.hpp); all of it where
//     little of the way is observed (u below), else a share: the next sweeps look at the same part of the map again
//   - the slow drift of the map itself, which goes with the distance driven, not with the number of sweeps (a standing
//     vehicle does not drift): a random walk in position, tilt and heading, per square root of a metre
//   - biases, from a sensor whose beams are off by the same every sweep: a heading error per metre and a scale error.
//     Unknown and constant; they make the error grow with distance squared and distance. Each head has its own (0.1 to
//     0.5 m per km of scale in ten simulated ones), so that one head's errors are alike on all its drives.
//   - faster than `slow_mps`, walk (standard deviation) and scale error grow as the speed: fewer sweeps see each place,
//     and fewer places are still seen
//   - what a new map costs: it holds the points of one sweep, between whose beams the pose settles 1 to 4 cm off within
//     the first 0.1 m of the way (five simulated standing starts), and tilted by 0.1 to 0.25 deg (moving starts)
//   - the error of a speed that is not observed: how large and how lasting it is says estimation/dead_reckoning.hpp; here, how
//     much of it goes into an increment
//
// calibrate_noise fits measured_ratio, position_ and heading_per_root_metre, heading_bias and scale_bias; the others
// are chosen by hand.
//
// Units m, rad unless the name says otherwise; covariances about the previous body's axes. Cost: none to speak of.
#pragma once

#include "core/geometry/pose.hpp"

namespace fail_aware {

class DriftModel {
 public:
  struct Params {
    double measured_ratio = 0.0;    ///< of the observed part's variance, that adds up, too
    double unobserved_ratio = 0.6;  ///< of the variance of what stays open, that adds up, at least
    double position_per_root_metre_m = 0.0;
    double tilt_per_root_metre_deg = 0.0065;
    double heading_per_root_metre_deg = 0.00035;
    double heading_bias_deg_per_m = 0.000012;  ///< standard deviation of the constant
    double scale_bias = 0.000035;              ///< likewise: metres per metre
    double slow_mps = 10.0;                    ///< faster, the walks and the scale bias grow with the speed
    double transient_ratio = 0.1;            ///< of the pose's own variance, that it jitters by about the map: position
    double transient_rotation_ratio = 0.02;  ///< likewise rotation
    double new_map_m = 0.02;  ///< standard deviation that the first 0.1 m in a new map add; tilt: 0.1 deg

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("measured_ratio", self.measured_ratio);
      v("unobserved_ratio", self.unobserved_ratio);
      v("position_per_root_metre_m", self.position_per_root_metre_m);
      v("tilt_per_root_metre_deg", self.tilt_per_root_metre_deg);
      v("heading_per_root_metre_deg", self.heading_per_root_metre_deg);
      v("heading_bias_deg_per_m", self.heading_bias_deg_per_m);
      v("scale_bias", self.scale_bias);
      v("slow_mps", self.slow_mps);
      v("transient_ratio", self.transient_ratio);
      v("transient_rotation_ratio", self.transient_rotation_ratio);
      v("new_map_m", self.new_map_m);
    }
    void validate() const;

    /// Errors of successive sweeps that know nothing of each other: all of a sweep's uncertainty stays.
    static Params independent();
  };

  /// Throws ParameterError.
  explicit DriftModel(const Params& params);

  /// How much faster than `slow_mps`: 1 (slower, or no time given) to 5.
  double pace(double distance_m, double dt_s) const;

  /// What a sweep adds for good. `increment`: the covariance of its motion, `unobserved`: the part of it that stays
  /// open.
  Matrix6d accumulated(const Matrix6d& increment, const Matrix6d& unobserved, double distance_m,
                       double pace = 1.0) const;
  /// What it adds for the moment: the pose's own jitter, half of an increment's, which is between two of them.
  Matrix6d transient(const Matrix6d& increment, const Matrix6d& unobserved) const;

  /// What the way from `from_m` to `to_m`, from where the map begins, adds for good: variances of position and tilt.
  Vector6d newMapVariances(double from_m, double to_m) const;

  /// Variances of the two constants: heading (rad^2/m^2) and scale.
  Eigen::Vector2d biasVariances() const;

  /// u: how little of the motion along the body's x axis is observed: 0 well, 1 not at all.
  double unobservedAlong(const Matrix6d& increment, const Matrix6d& unobserved) const;

 private:
  double accumulatedRatioOfOpen(double unobserved_along) const;

  Params params_;
};

}  // namespace fail_aware
