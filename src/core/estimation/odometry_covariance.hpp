// The covariance of the accumulated odometry (not in the paper): what is published as odometry.pose.covariance. The
// filter's P settles to a steady level; this one adds up what stays of each sweep's uncertainty, so that it grows with
// distance and a heading error turns into a position error over the distance driven after it.
//
// Two errors: m, of the map around the vehicle, and d, of the pose in this map; the pose's is m + d. In a sweep
//   d += error of the motion without the map (the filter's process noise; an unobserved speed),
//   d -> (I - K) d, K = D (D + R)^-1: the registration takes back what it observes; R its covariance, D that of d,
//   m += a d, d -> (1 - a) d: the sweep replaces the part a of the map (drift_model.hpp), and
//   m += a part of K R K^T: what the registrations that make a map have in common; random walks.
// So where registration is good, the pose goes with the map. Along a tunnel d grows, and so m; a place without
// information shorter than the map costs nothing, since the map from before it is seen again.
// After a pose that is a prediction (sensor gone for a moment) nothing is taken back until two measurements agree, or
// one alone holds for 20 sweeps; if the prediction becomes too uncertain for a search, or too old, the map is out of
// sight: d stays for good.
//
// Beside them it carries, with their correlations: heading bias per metre, scale bias (both constant), and the error
// of the speed along the vehicle's axis during dead reckoning (successive errors are then alike, not independent).
//
// Convention: geometry/pose.hpp's (m, rad; rotation about fixed axes).
// Height, roll and pitch have in addition what the vertical reference knows of them (vertical_drift.hpp).
// Failure: propagate() returns false and changes nothing (poses or covariance not finite). Cost: some 15x15 products.
#pragma once

#include <optional>

#include "core/estimation/drift_model.hpp"
#include "core/estimation/drift_state.hpp"
#include "core/estimation/vertical_drift.hpp"
#include "core/geometry/pose.hpp"
#include "core/types/odometry_increment.hpp"

namespace fail_aware {

/// How the last sweep makes the error grow, if sweeps like it follow: about the previous body's axes.
struct DriftRate {
  struct Along {
    double variance_m2 = 0.0;  ///< of one sweep
    double speed_share = 0.0;  ///< of an error along the vehicle in d, that stays for good, 0..1
  };
  Matrix6d covariance = Matrix6d::Zero();  ///< of one sweep
  double speed_share = 0.0;                ///< as in Along
  Along on_weak_stretch;                   ///< if the registration hardly knew the way along the road
  bool open = false;                       ///< since a predicted pose: a registration may take the error back
};

class OdometryCovariance {
 public:
  /// Throws ParameterError.
  explicit OdometryCovariance(const DriftModel& drift);

  /// Negative eigenvalues of the increment's covariances count as zero.
  bool propagate(const Pose& T_odom_cog_previous, const Pose& T_odom_cog_now, const OdometryIncrement& increment);

  /// Of T_odom_cog, about odom's axes. The jitter in it is the largest so far: it does not shrink with the way.
  const Matrix6d& covariance() const { return covariance_; }
  /// Of the error of the speed, m^2/s^2; 0 where it is observed.
  double speedVariance() const { return since_start_.speedVariance(); }

  /// Begins anew.
  void reset(const Matrix6d& start_covariance = Matrix6d::Zero());

  /// The vehicle was set to another pose in odom, and a new map begins there. Covariances stay.
  void enterOdom();

  /// The pose counts as right from here on. Zero if it is not finite.
  DriftSinceMark mark(const Pose& T_odom_mark) const;

  /// Of the last propagate() that returned true.
  const DriftStep& lastStep() const { return last_step_; }
  DriftRate rate() const;

 private:
  struct MapDistance {  ///< how far the vehicle came from where the map began
    Eigen::Vector3d begin_odom = Eigen::Vector3d::Zero();
    double farthest_m = 0.0;
  };
  static constexpr int kConfirmed = -1;
  struct Confirmation {
    int open_sweeps = kConfirmed;  ///< since a predicted pose; kConfirmed: a pose was confirmed since
    int alone_in_a_row = 0;        ///< registered sweeps that one source alone measured
    bool measured = false;         ///< the newest sweep
  };

  Confirmation takeRegistration(const OdometryIncrement& increment, const Matrix6d& in_map, DriftStep& step) const;
  MapDistance extendMap(const OdometryIncrement& increment, const Pose& T_odom_cog_previous, const Pose& T_odom_cog_now,
                        DriftStep& step) const;
  DriftRate::Along rateOnWeakStretch() const;

  DriftModel drift_;
  DriftState since_start_;
  VerticalDrift vertical_;  ///< since the start, in addition; nothing that is horizontal depends on it
  Matrix6d covariance_ = Matrix6d::Zero();
  Matrix6d transient_cog_ = Matrix6d::Zero();          ///< jitter of the newest pose, about its own axes
  Matrix6d largest_transient_cog_ = Matrix6d::Zero();  ///< no less than any so far
  std::optional<MapDistance> map_distance_;
  Confirmation confirmation_;
  DriftStep last_step_;
};

}  // namespace fail_aware
