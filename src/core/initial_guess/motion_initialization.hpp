// Search for the first motion (not in the paper). Before two sweeps have been registered the speed is unknown. At
// 30 m/s the vehicle moves 3 m between the first two sweeps, far beyond any correspondence distance.
//
// The search tries forward speeds and yaw rates in steps: it moves the second sweep accordingly and scores it by the
// distances of its points to the first sweep. Neither sweep is deskewed, so both are distorted alike. Misleading points
// are removed or limited:
// - The scan line pattern on the ground, slopes included, moves with the sensor and fits best at standstill: only
//   points at least 0.4 m above the lowest point of their column are used.
// - Walls and rails along the road fit at any speed but, if thinned, best at standstill: the sweeps stay dense.
// - A vehicle ahead that keeps its distance: each cell has one vote, so that the scenery outvotes the vehicle.
// - Hedges and rails fit a little better at standstill, as the beams hit them in the same pattern. The score is the log
//   likelihood of all votes, so a pole that meets nothing counts more than ten places that meet a little less well.
// - A vehicle that travels along hides what is behind it, and its shadow travels along, too: points at the shadow's
//   edge meet nothing at the true speed. What the first sweep could not see speaks neither for nor against a speed.
// - At a true standstill the beams hit the same spots, so that nearly everything meets within centimetres. If
//   standstill fits best but not that well, another speed that stands out of all the others is taken.
// Limit: where the scenery looks the same at every speed (a smooth tunnel) the vehicle ahead still wins;
// first_motion.hpp inflates the covariance in this case (`standstill_ratio`).
// Failure: nullopt. Cost: about 150 ms, on the second sweep, and where the search starts again
// (estimation/pose_filter).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/initial_guess/occlusion_image.hpp"
#include "core/map/above_ground_points.hpp"
#include "core/map/voxel_map.hpp"
#include "core/parameters/check.hpp"
#include "core/types/corrected_sweep.hpp"

namespace fail_aware {

class MotionInitialization {
 public:
  struct Params {
    double min_speed_mps = -5.0;
    double max_speed_mps = 45.0;
    /// coarse steps, followed by finer ones around the best; 0.2 m per sweep at 10 Hz, within kernel_m
    double step_mps = 2.0;
    double max_yaw_rate_rps = 0.7;
    double step_yaw_rate_rps = 0.1;  ///< steps of the yaw rate: 0.3 m at a range of 30 m and 10 Hz, like kernel_m
    /// speed times yaw rate: faster turns are not tried, because tyres cannot hold them
    double max_lateral_acceleration_mps2 = 8.0;
    double max_range_m = 60.0;  ///< farthest points used: beyond it points are sparse
    double thinning_m = 0.1;    ///< voxel size of the sweeps: coarser sweeps fit best at standstill, see above
    double kernel_m = 0.5;      ///< Geman-McClure scale of the distance to the nearest point; 0.15 m at the end
    /// cells, one vote each, of about the size of a vehicle, so that one ahead has few votes; within a column a slope
    /// lifts a point by less than 0.4 m, and a kerb is no higher
    AboveGroundPointsParams above_ground{3.0, 0.5, 0.4};
    /// While the speed is unknown, a sweep that moved less than standstill_m counts as standing only if its weakest
    /// horizontal direction has at least standstill_ratio of the information: objects that travel with the vehicle
    /// imitate standstill. The search rejects a step below standstill_m that fits badly; 0: it does not, and
    /// drive_off.hpp is not used.
    double standstill_m = 0.3;
    double standstill_ratio = 0.15;

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("min_speed_mps", self.min_speed_mps, within(-100.0, 100.0));
      v("max_speed_mps", self.max_speed_mps);
      v("max_yaw_rate_rps", self.max_yaw_rate_rps, within(0.0, 10.0));
      v("standstill_m", self.standstill_m, requireNotNegative);
      v("standstill_ratio", self.standstill_ratio, within(0.0, 1.0));
    }
    void checkRules() const;
  };

  /// The step of the last search, as a ratio of the first step.
  static constexpr double kFineStep = 0.25;

  /// `min_range_m`: nearer points belong to the vehicle.
  MotionInitialization(const Params& params, double min_range_m);

  /// The sweep that later ones are compared with. Points are used as they are: pass a sweep that is not deskewed.
  void setFirst(const CorrectedSweep& sweep, const Pose& T_cog_lidar);

  struct Found {
    Vector6d twist_cog = Vector6d::Zero();  ///< m/s, rad/s; forward speed and yaw rate only
    double places_met = 0.0;                ///< number of cells whose above-ground points meet the first sweep
  };
  /// The motion of the centre of gravity between the first sweep and this one, dt_s later. Returns nullopt before
  /// setFirst(), or if no above-ground point meets the first sweep at any speed.
  std::optional<Found> find(const CorrectedSweep& sweep, const Pose& T_cog_lidar, double dt_s) const;

  /// How far the vehicle, if it stood at the first sweep, has come since, along its own axis (drive_off.hpp).
  /// turned_rad: how far it has turned. standing_ratio: it stands if at least this ratio of the places meets there.
  /// Returns nullopt before setFirst(), or if no distance stands out. Cost: 8 to 20 ms.
  std::optional<double> findDistance(const CorrectedSweep& sweep, const Pose& T_cog_lidar, double turned_rad,
                                     double standing_ratio) const;

  void reset();

  const Params& params() const { return params_; }

 private:
  /// At most about `enough` of them.
  AboveGroundPoints aboveGround(const CorrectedSweep& sweep, const Pose& T_cog_lidar, std::size_t enough) const;
  std::vector<Eigen::Vector3f> thinned(const CorrectedSweep& sweep, const Pose& T_cog_lidar) const;

  Params params_;
  double min_range_m_;
  VoxelMap first_;
  OcclusionImage hidden_in_first_;
};

}  // namespace fail_aware
