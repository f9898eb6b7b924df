// The thinned clouds that the measurements register: three clouds in the frame of the centre of gravity, from one pass
// over a corrected sweep.
//
// `map` (finest) goes into the reference; `plane` is registered point to plane, `point` point to point; both are
// subsets of `map`. A compensated sweep has no times (sensor.timing.source none: KITTI's odometry scans). It is timed
// by its azimuth, as if the revolution took 0.1 s, relative to its middle. These times serve to remove the remaining
// turn, which is assumed to be zero at the middle.
// Deterministic: preprocessing/voxel_filter chooses one point per voxel.
// Cost: about 10 ns per point.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/parameters/check.hpp"
#include "core/preprocessing/timing.hpp"
#include "core/preprocessing/voxel_filter.hpp"
#include "core/types/beam_bias.hpp"
#include "core/types/corrected_sweep.hpp"

namespace fail_aware {

struct RegistrationCloud {
  double stamp_s = 0.0;
  double middle_s = 0.0;     ///< middle of the points' times, relative to the stamp; 0: no timing
  bool compensated = false;  ///< deskewed by another system for an unknown motion, and timed by its azimuth
  std::vector<Eigen::Vector3f> map_points_cog;
  std::vector<float> map_times_s;  ///< relative to the stamp (compensated: to the middle); empty: no timing
  std::vector<Eigen::Vector3f> plane_points_cog;
  std::vector<float> plane_times_s;
  std::vector<std::uint16_t> plane_rings;  ///< empty: unknown
  std::vector<Eigen::Vector3f> point_points_cog;
  std::vector<float> point_times_s;

  /// Moves all points for a refined motion: delta_twist_cog (m/s, rad/s) is the motion that the deskew missed. Points
  /// measured at still_s (relative to the stamp) do not move.
  void redeskewBy(const Vector6d& delta_twist_cog, double still_s = 0.0);
};

class RegistrationCloudBuilder {
 public:
  struct Params {
    double min_range_m = 3.0;  ///< nearer points belong to the vehicle
    double max_range_m = 100.0;
    double map_voxel_m = 0.25;
    double plane_voxel_m = 1.0;
    double point_voxel_m = 1.5;
    int min_points = 500;  ///< a sweep with fewer points after thinning to map_voxel_m is not registered

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("min_range_m", self.min_range_m, requireNotNegative);
      v("max_range_m", self.max_range_m);
      v("map_voxel_m", self.map_voxel_m, within(0.01, 100.0));
      v("plane_voxel_m", self.plane_voxel_m);
      v("point_voxel_m", self.point_voxel_m);
      v("min_points", self.min_points, within(1, 1e9));
    }
    void checkRules() const;
  };

  /// compensated_head: the rotation of the head for compensated sweeps; nullopt: sweeps without times get none.
  explicit RegistrationCloudBuilder(const Params& params,
                                    const std::optional<SweepTimingParams>& compensated_head = std::nullopt);

  /// `cloud` is reused: no allocation once its arrays have grown. bias: is taken out of the points of sweeps with
  /// rings.
  void build(const CorrectedSweep& sweep, const Pose& T_cog_lidar, RegistrationCloud& cloud, const BeamBias& bias = {});

  const Params& params() const { return params_; }

 private:
  Params params_;
  std::optional<SweepTimingParams> compensated_head_;
  VoxelFilter filter_;
  /// indices into the sweep (first), into the map's points (others)
  std::vector<std::uint32_t> of_sweep_, chosen_;
};

}  // namespace fail_aware
