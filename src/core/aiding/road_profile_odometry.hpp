// Odometry by the road's profile, for places where nothing else observes the motion along the road (a tunnel). Not in
// the paper.
//
// The profile of a sweep (road_profile_window.hpp) appears again in the next sweeps, shifted by the distance driven.
// findPlace() finds the newest sweep among the earlier ones at their estimated poses. As long as nothing is known of
// the motion, there are no such poses, and findSpeed() looks for it:
// the sweeps of the last two seconds are overlaid for speeds v and accelerations a:
//   E(v, a) = sum over cells of (S^2 - sum_k S_k^2) / (W + 1/s^2)
// with S_k, W_k: sums of w * height and w of sweep k, s: `profile_sigma_m`; only products of different sweeps count.
// The peak is found by E and refined by the correlation: E relative to what it is if all sweeps are equal. It is
// accepted if it is distinct. Its sigma grows with the fit of the opposite motion: what changes slowly in the sensor's
// frame (a vehicle that pitches) fits both motions alike. The shape of the path (heading) comes from the poses.
//
// Failure: nullopt, if there are too few sweeps, too little road or no profile (at standstill the profile is part of
// the mean).
// Cost: 2 ms per sweep, 3 ms for a place; a speed 30 ms, near the last one 5 ms.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "core/aiding/road_place.hpp"
#include "core/aiding/road_profile_window.hpp"
#include "core/geometry/pose.hpp"
#include "core/parameters/check.hpp"
#include "core/types/corrected_sweep.hpp"

namespace fail_aware {

class RoadProfileOdometry {
 public:
  struct Params {
    bool enabled = true;
    /// sweeps that are compared: 2 s at 10 Hz, during which the acceleration is nearly constant
    int window_sweeps = 20;
    int min_sweeps = 10;   ///< fewer sweeps give no speed: half a window
    double cell_m = 0.25;  ///< cell of the grid of heights: a quarter of the profile's length
    /// half the side of the square whose fitted line is subtracted: longer than the profile, shorter than the road's
    /// crown
    double smoothing_m = 1.5;
    double profile_sigma_m = 0.002;  ///< height of the profile, relative to which noise is weighed
    double min_speed_mps = -5.0;
    double max_speed_mps = 45.0;
    /// largest acceleration and braking within the window: beyond it is emergency braking
    double max_acceleration_mps2 = 4.0;
    double min_correlation = 0.1;  ///< least correlation of the sweeps at the peak
    /// largest second peak, as a ratio of the highest, in a search over all speeds: with two similar peaks neither is
    /// reliable
    double max_second_peak = 0.7;
    /// sigma of a result; consecutive results have similar errors, so larger than their scatter (0.2)
    double speed_sigma_mps = 0.6;
    double mirrored_sigma_mps = 8.0;  ///< added, times the ratio of the energy at the opposite motion

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("enabled", self.enabled);
      v("min_speed_mps", self.min_speed_mps, within(-100.0, 100.0));
      v("max_speed_mps", self.max_speed_mps);
    }
    void checkRules() const;
  };

  struct Speed {
    double speed_mps = 0.0;  ///< at the newest sweep's stamp
    double acceleration_mps2 = 0.0;
    double sigma_mps = 0.0;
  };

  explicit RoadProfileOdometry(const Params& params)
      : params_(params), window_(params.window_sweeps, params.cell_m, params.smoothing_m) {}

  /// As RoadProfileWindow::add.
  void add(const CorrectedSweep& sweep, const Pose& T_cog_lidar, const Vector6d& twist_cog, const Pose& T_odom_cog) {
    window_.add(sweep, T_cog_lidar, twist_cog, T_odom_cog);
    if (window_.size() <= 1) last_.reset();
  }

  /// The estimated pose of the sweep added last.
  void setPose(const Pose& T_odom_cog, bool moves_all = false) { window_.setPose(T_odom_cog, moves_all); }

  /// The sweeps so far lie on the path that this speed gives, and not at the poses that were estimated.
  void setPath(const Speed& speed) { window_.setPath(speed.speed_mps, speed.acceleration_mps2); }

  /// The place of the newest sweep. expected_sigma_m: of its prediction; beyond 0.4 m none is looked for.
  std::optional<RoadPlace> findPlace(double expected_sigma_m) const;

  /// The speed from the sweeps so far, searched near the last result or the expected speed, if there is one. A speed
  /// more than 3 sigma from the expected one is rejected, even if the expected one is uncertain: beams that change (a
  /// sweep distorted differently) can look like a profile, and what travels with the sensor fits at standstill.
  std::optional<Speed> findSpeed(double expected_mps = 0.0,
                                 double expected_sigma_mps = std::numeric_limits<double>::infinity());

  /// The last search found a speed.
  bool hasSpeed() const { return last_.has_value(); }

  void clear();

  const Params& params() const { return params_; }

 private:
  struct Score {
    double energy = 0.0, correlation = 0.0;
  };
  struct MiddleMotion {
    double speed_mps = 0.0;  ///< in the middle of the window
    double acceleration_mps2 = 0.0;
  };

  Score score(const std::vector<RoadProfile>& profiles, const MiddleMotion& motion) const;
  void climb(const std::vector<RoadProfile>& profiles, MiddleMotion& motion) const;
  std::optional<double> searchAllSpeeds(const std::vector<RoadProfile>& profiles) const;

  Params params_;
  RoadProfileWindow window_;
  std::optional<Speed> last_;
  double last_stamp_s_ = 0.0;
  mutable std::vector<float> grid_;  ///< working memory of score()
};

}  // namespace fail_aware
