// The vehicle's speed from the road profile, for places where nothing else observes it (a tunnel). Not in the paper.
//
// A road is uneven: its profile, millimetres high and about a metre long, appears again in the next sweeps, shifted by
// the distance driven. It is far smaller than a point's noise and the errors of the beams, but
// - tens of thousands of points see it, at grazing incidence, where range noise hardly affects the height;
// - what travels with the sensor (errors of beams, a vehicle ahead, the crown of the road) is the same in every sweep
//   in the same direction from the sensor; the mean of the last sweeps is subtracted, direction by direction.
// The remaining heights go onto a grid, minus their mean within `smoothing_m` to each side. The sweeps of the last two
// seconds are overlaid for speeds v and accelerations a:
//   E(v, a) = sum over cells of (S^2 - sum_k S_k^2) / (W + 1/s^2)
// with S_k, W_k: sums of w * height and w of sweep k, s: `profile_sigma_m`; only products of different sweeps count.
// The peak is accepted if it is distinct. Its sigma grows with the fit of the opposite motion: what changes slowly in
// the sensor's frame (a vehicle that pitches) fits both motions alike. The shape of the path (heading) comes from the
// odometry's estimates.
//
// Failure: nullopt, if there are too few sweeps, too little road or no profile (at standstill the profile is part of
// the mean).
// Cost: about 2 ms per sweep; a search over all speeds about 30 ms, one near the last speed about 5 ms.
#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <unordered_map>
#include <vector>

#include "core/aiding/road_surface.hpp"
#include "core/geometry/pose.hpp"
#include "core/parameters/check.hpp"
#include "core/preprocessing/voxel_key.hpp"
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
    /// half the side of the square whose mean height is subtracted: longer than the profile, shorter than the road's
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

  explicit RoadProfileOdometry(const Params& params) : params_(params) {}

  /// `twist_cog` is the motion (m/s, rad/s) that the sweep was deskewed for, `yaw_rad` the vehicle's heading.
  void add(const CorrectedSweep& sweep, const Pose& T_cog_lidar, const Vector6d& twist_cog, double yaw_rad);

  /// Sets a better heading for the sweep added last.
  void setYaw(double yaw_rad);

  /// The speed from the sweeps so far, searched near the last result if there is one. A speed more than 3 sigma from
  /// the expected speed is rejected, even if the expected speed itself is uncertain: beams that change (a sweep
  /// distorted differently) can look like a profile, and what travels with the sensor fits at standstill.
  std::optional<Speed> findSpeed(double expected_mps = 0.0,
                                 double expected_sigma_mps = std::numeric_limits<double>::infinity());

  /// The last search found a speed.
  bool hasSpeed() const { return last_.has_value(); }

  void clear();

  std::size_t sweeps() const { return sweeps_.size(); }
  const Params& params() const { return params_; }

 private:
  struct Sample {
    std::uint32_t direction;
    float x, y, time_s, height, weight;
  };
  struct Record {
    double stamp_s;
    double yaw_rad;
    double speed_mps;  ///< that the sweep was deskewed for
    std::vector<Sample> samples;
  };
  struct Mean {
    double sum = 0.0;
    int count = 0;
  };
  struct Cell {
    float x, y, time_s, height, weight;
  };
  struct Score {
    double energy = 0.0, correlation = 0.0;
  };
  struct Layer {
    double age_s, cos_yaw, sin_yaw, tan_half_yaw, speed_mps;
    std::vector<Cell> cells;
  };

  void forgetOldest();
  std::vector<Layer> layers() const;
  Score score(const std::vector<Layer>& layers, double speed_mps, double acceleration_mps2) const;
  std::optional<double> searchAllSpeeds(const std::vector<Layer>& layers) const;

  Params params_;
  std::deque<Record> sweeps_;
  std::unordered_map<VoxelKey, std::uint32_t, VoxelHash> directions_;
  std::vector<Mean> means_;
  std::optional<Speed> last_;
  double last_stamp_s_ = 0.0;
  mutable std::vector<float> grid_;
};

}  // namespace fail_aware
