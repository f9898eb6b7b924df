// The vehicle's speed from the relief of the road, where nothing else stands across it (a tunnel). Not in the article.
//
// A road is not even: its unevenness, millimetres high and about a metre long, is seen again in the next sweeps,
// shifted by the way driven. It lies far below a point's noise and the errors of the beams, but
// - tens of thousands of points see it, at grazing incidence, where range noise hardly enters the height;
// - what travels with the sensor (errors of beams, a vehicle ahead, the crown of the road) is the same in every sweep
//   in the same direction from the sensor; its mean over the last sweeps is taken off, direction by direction.
// What is left is put on a grid, less its mean within `smoothing_m` to each side; the sweeps of the last two seconds are
// laid over each other for speeds v and accelerations a: E(v, a) = sum over cells of (S^2 - sum_k S_k^2) / (W + 1/s^2),
// S_k, W_k: sums of w * height and w of sweep k, s: `profile_sigma_m`; products of different sweeps only. The peak is
// taken if it stands out; the better the opposite motion fits, the less it is trusted: what changes slowly in the
// sensor's own frame (a vehicle that pitches) fits both alike. The shape of the path (heading) comes from the
// odometry's own estimates.
//
// Failure: nothing, if there are too few sweeps, too little road, no relief (or a vehicle that stands still: then the
// relief is part of the mean).
// Cost: a sweep about 2 ms, a search over all speeds about 30 ms, one near the last speed about 5 ms.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <unordered_map>
#include <vector>

#include "fail_aware_lidar_odometry/core/cloud/voxel_key.hpp"
#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"
#include "fail_aware_lidar_odometry/core/registration/road_surface.hpp"
#include "fail_aware_lidar_odometry/core/types/corrected_sweep.hpp"

namespace fail_aware {

class RoadProfileOdometry {
 public:
  struct Params {
    bool enabled = true;
    /// sweeps that are compared: 2 s at 10 Hz, in which the acceleration is nearly constant
    int window_sweeps = 20;
    int min_sweeps = 10;  ///< fewer sweeps give no speed: half a window
    /// nearest points used, horizontal, from the lidar: nearer ones are the vehicle's own
    double min_range_m = 3.0;
    double max_range_m = 16.0;  ///< farthest points used: farther beams are too grazing
    double half_width_m = 4.0;  ///< half the width of the strip of road used: own lane and its neighbours
    /// elevation of the bins in which the mean is taken: a fraction of the beams' spacing
    double direction_elevation_deg = 0.1;
    double direction_azimuth_deg = 0.5;  ///< azimuth of these bins: 0.14 m at max_range_m, less than a cell
    /// what stands out more is not the road: the relief is millimetres, range noise centimetres
    double max_height_m = 0.03;
    double cell_m = 0.25;  ///< cell of the grid of heights: a quarter of the relief's length
    /// half the side of the square whose mean height is subtracted: longer than the relief, shorter than the road's
    /// crown
    double smoothing_m = 1.5;
    double profile_sigma_m = 0.002;  ///< height of the relief, against which noise is weighed
    double min_speed_mps = -5.0;
    double max_speed_mps = 45.0;
    /// largest acceleration and braking within the window: beyond it is emergency braking
    double max_acceleration_mps2 = 4.0;
    double min_correlation = 0.1;  ///< least correlation of the sweeps at the peak
    /// largest second peak, as a ratio of the highest, in a search over all speeds: with two similar peaks none is
    /// reliable
    double max_second_peak = 0.7;
    /// sigma of a result; errors of consecutive results are alike, so larger than theirs (0.2)
    double speed_sigma_mps = 0.6;
    double mirrored_sigma_mps = 8.0;  ///< added, times the ratio of the energy that the opposite motion has

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("enabled", self.enabled);
      v("min_speed_mps", self.min_speed_mps);
      v("max_speed_mps", self.max_speed_mps);
    }
    void validate() const;

    RoadSurfaceParams surface() const {
      return {min_range_m, max_range_m, half_width_m, direction_elevation_deg, direction_azimuth_deg, max_height_m};
    }
  };

  struct Speed {
    double speed_mps = 0.0;  ///< at the newest sweep's stamp
    double acceleration_mps2 = 0.0;
    double sigma_mps = 0.0;
    double correlation = 0.0;
  };

  explicit RoadProfileOdometry(const Params& params);

  /// `twist_cog` is the motion (m/s, rad/s) that the sweep was corrected for, `yaw_rad` the vehicle's heading.
  void add(const CorrectedSweep& sweep, const Pose& T_cog_lidar, const Vector6d& twist_cog, double yaw_rad);

  /// A better heading for the sweep added last.
  void setYaw(double yaw_rad);

  /// From the sweeps so far; near the last result if there was one. What lies more than 3 sigma from the speed that the
  /// vehicle should have is none, however doubtful it is itself: beams that change (a sweep bent otherwise) can look like
  /// a relief, too, and what travels with the sensor fits at standstill.
  std::optional<Speed> findSpeed(double expected_mps = 0.0,
                                 double expected_sigma_mps = std::numeric_limits<double>::infinity());

  /// Whether the last search found one.
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
    double speed_mps;  ///< corrected for
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
