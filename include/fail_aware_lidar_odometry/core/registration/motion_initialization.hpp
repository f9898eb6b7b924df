// The first motion. Until two sweeps have been registered nothing is known of the speed: a car at 30 m/s moves 3 m
// between the first two sweeps, far beyond any correspondence distance. Not in the article.
//
// Forward speeds and yaw rates are tried in steps: the second sweep is moved accordingly and scored by its points'
// distances to the first one. Both are uncorrected, hence bent alike. What would tell a wrong story is left out or kept
// small:
// - ground, slopes too, whose pattern of scan lines travels with the sensor and fits best at standstill: only points
//   that stand `min_height_m` above the lowest of their column are used;
// - walls and rails along the road, which fit at any speed but, thinned, best at standstill: the sweeps are kept dense;
// - a car ahead that keeps its distance: one vote a cell, so that scenery outvotes it.
// Limit: where scenery looks the same at every speed (a smooth tunnel) the vehicle ahead still wins; first_motion.hpp
// doubts that (`standstill_ratio`).
// Cost: about 150 ms, on the second sweep only.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "fail_aware_lidar_odometry/core/cloud/voxel_map.hpp"
#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"
#include "fail_aware_lidar_odometry/core/registration/above_ground_points.hpp"
#include "fail_aware_lidar_odometry/core/types/corrected_sweep.hpp"

namespace fail_aware {

class MotionInitialization {
 public:
  struct Params {
    double min_speed_mps = -5.0;
    double max_speed_mps = 45.0;
    /// coarse steps; then finer ones around the best; 0.2 m a sweep at 10 Hz, within kernel_m
    double step_mps = 2.0;
    double max_yaw_rate_rps = 0.7;
    double step_yaw_rate_rps = 0.1;  ///< steps of the yaw rate: at 10 Hz 0.3 m at a range of 30 m, as kernel_m
    /// speed times yaw rate: faster turns are not tried; tyres hold no more
    double max_lateral_acceleration_mps2 = 8.0;
    double max_range_m = 60.0;  ///< farthest points used: beyond it points are sparse
    double thinning_m = 0.1;    ///< voxel size of the sweeps: coarser sweeps fit best at standstill, see above
    double kernel_m = 0.3;      ///< Geman-McClure scale of the distance to the nearest point; half of it at the end
    double cell_m = 3.0;        ///< horizontal cells, one vote each: about a car, so that one ahead has few
    /// horizontal size of the columns in which height is measured: a slope lifts a point by less than min_height_m in
    /// it
    double column_m = 0.5;
    double min_height_m = 0.4;  ///< a point this far above the lowest of its column stands: a kerb does not
    /// While the speed is unknown, a sweep that has moved less than this is taken to stand only if its weakest
    /// horizontal direction has at least this share of the information: what travels with the vehicle makes it seem to
    /// stand.
    double standstill_m = 0.1;
    double standstill_ratio = 0.15;

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("min_speed_mps", self.min_speed_mps);
      v("max_speed_mps", self.max_speed_mps);
      v("max_yaw_rate_rps", self.max_yaw_rate_rps);
      v("standstill_m", self.standstill_m);
      v("standstill_ratio", self.standstill_ratio);
    }
    void validate() const;
  };

  /// The last search's step, as a share of the first one's.
  static constexpr double kFineStep = 0.25;

  /// `min_range_m`: nearer points are the vehicle's own.
  explicit MotionInitialization(const Params& params, double min_range_m);

  /// The sweep that later ones are compared with. Points are taken as they are: pass uncorrected ones.
  void setFirst(const CorrectedSweep& sweep, const Pose& T_cog_lidar);

  /// The twist (m/s, rad/s; only forward speed and yaw rate) of the centre of gravity between the first sweep and this
  /// one, dt_s later. Nothing before setFirst(), or if at no speed anything that stands meets the first sweep.
  /// `places_met`: how many cells' worth of standing points meet the first sweep there.
  std::optional<Vector6d> findTwist(const CorrectedSweep& sweep, const Pose& T_cog_lidar, double dt_s,
                                    double* places_met = nullptr) const;

  void reset();

  const Params& params() const { return params_; }

 private:
  std::vector<Eigen::Vector3f> thinned(const CorrectedSweep& sweep, const Pose& T_cog_lidar) const;

  Params params_;
  double min_range_m_;
  VoxelMap first_;
};

}  // namespace fail_aware
