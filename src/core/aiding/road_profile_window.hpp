// The road's profile (its unevenness: millimetres high, about a metre long) in each of the last sweeps. Not in the
// paper.
//
// It is far smaller than a point's noise and the errors of the beams, but
// - tens of thousands of points see it, at grazing incidence, where range noise hardly affects the height;
// - what travels with the sensor (errors of beams, a vehicle ahead, the crown of the road) is the same in every sweep
//   in the same direction from the sensor; the mean of the last sweeps is subtracted, direction by direction.
// The remaining heights go onto a grid, less the line that fits them within `smoothing_m` to each side.
// Frames: axes of the vehicle, origin at the lidar. Units m, s, rad.
//
// Failure: none; a sweep without enough road clears the window. Cost: about 2 ms per sweep for add(), 2 ms for
// profiles().
#pragma once

#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

#include "core/aiding/road_surface.hpp"
#include "core/geometry/pose.hpp"
#include "core/preprocessing/voxel_key.hpp"
#include "core/types/corrected_sweep.hpp"

namespace fail_aware {

/// The road in one sweep.
struct RoadProfile {
  struct Cell {
    float x, y;    ///< its centre
    float time_s;  ///< of its points, relative to the sweep's stamp
    float height;  ///< m, above the neighbourhood
    float weight;  ///< of the height, 1/m^2
  };
  double age_s = 0.0;                     ///< before the newest sweep
  Pose T_newest_this = Pose::Identity();  ///< by the estimates; the newest's pose is a prediction
  double speed_mps = 0.0;                 ///< that the sweep was deskewed for
  double faster_mps = 0.0;                ///< what is known of the difference from the true speed
  std::vector<Cell> cells;
};

class RoadProfileWindow {
 public:
  RoadProfileWindow(int sweeps, double cell_m, double smoothing_m)
      : max_sweeps_(static_cast<std::size_t>(sweeps)), cell_m_(cell_m), smoothing_m_(smoothing_m) {}

  /// `twist_cog`: the motion (m/s, rad/s) that the sweep was deskewed for, `T_odom_cog`: where it is predicted. After a
  /// gap the window begins with this sweep.
  void add(const CorrectedSweep& sweep, const Pose& T_cog_lidar, const Vector6d& twist_cog, const Pose& T_odom_cog);

  /// The estimated pose of the newest sweep. moves_all: the earlier sweeps move with it, as they lie rightly relative
  /// to its pose so far.
  void setPose(const Pose& T_odom_cog, bool moves_all = false);

  /// The earlier sweeps lie on the path that is driven at this speed, whatever was estimated then. The path ends at the
  /// newest sweep and moves with its next setPose().
  void setPath(double speed_mps, double acceleration_mps2);

  /// From the oldest to the newest. A sweep's mean leaves out itself and the sweeps within `alike_m` of it: they hold the
  /// same piece of the road, and at either end of the window on one side only, which would shift the profile.
  std::vector<RoadProfile> profiles(double alike_m) const;

  void clear();

  std::size_t size() const { return sweeps_.size(); }
  double newestStamp_s() const { return sweeps_.back().stamp_s; }

 private:
  struct Sample {
    std::uint32_t direction;
    float x, y, time_s, height, weight;
  };
  struct Mean {
    double sum = 0.0;
    int count = 0;

    void add(float height) {
      sum += static_cast<double>(height);
      ++count;
    }
    void remove(float height) {
      sum -= static_cast<double>(height);
      --count;
    }
  };
  struct Record {
    double stamp_s = 0.0;
    Eigen::Vector3d lidar_cog = Eigen::Vector3d::Zero();
    Pose T_odom_lidar = Pose::Identity();  ///< the vehicle's axes
    double speed_mps = 0.0, faster_mps = 0.0;
    std::vector<Sample> samples;
  };

  Pose relativePose(const Record& record) const { return sweeps_.back().T_odom_lidar.inverse() * record.T_odom_lidar; }
  std::vector<Mean> meansWithout(const Record& from, double alike_m) const;
  std::vector<RoadProfile::Cell> cells(const Record& record, const std::vector<Mean>& means) const;

  std::size_t max_sweeps_;
  double cell_m_, smoothing_m_;
  std::deque<Record> sweeps_;
  std::unordered_map<VoxelKey, std::uint32_t, VoxelHash> directions_;
  std::vector<Mean> means_;  ///< by direction
  bool path_is_set_ = false;
};

}  // namespace fail_aware
