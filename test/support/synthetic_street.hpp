// A made-up street and a spinning lidar in it, for tests of whole drives: every ray is intersected analytically with
// the ground (z = 0), boxes (houses, garden walls, parked cars) and poles. The street runs along x, from -80 m on to
// 240 m.
// The same seed gives the same points; the scene itself has no seed.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/geometry/pose.hpp"
#include "fail_aware_lidar_odometry/sweep.hpp"

namespace fail_aware {
namespace synthetic {

/// Turns clockwise seen from above, begins at the rear, its stamp is the sweep's middle (facing forward), as KITTI's.
struct Lidar {
  int beams = 64;
  int columns = 300;
  double lowest_deg = -24.0, highest_deg = 6.0;
  double max_range_m = 70.0;
  double noise_m = 0.01;  ///< along the ray, standard deviation
  double period_s = 0.1;
  bool rolling_shutter = true;
  Pose T_base_lidar = poseFromVector((Vector6d() << -0.595, 0.0, 1.73, 0.0, 0.0, 0.0).finished());
};

/// Constant twist of base_link on the ground.
struct Drive {
  double speed_mps = 14.0;
  double yaw_rate_rps = 0.05;
  Pose T_start = poseFromVector((Vector6d() << 0.0, 0.0, 0.0, 0.0, 0.0, -0.1).finished());

  Pose T_street_base(double time_s) const;
  /// What odometry that began at `begin_s` should say.
  Pose T_odom_base(double time_s, double begin_s = 0.0) const {
    return T_street_base(begin_s).inverse() * T_street_base(time_s);
  }
};

class Street {
 public:
  Street();

  /// Along a unit direction; infinity if there is nothing within max_range_m.
  double range(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double max_range_m) const;

  /// The sweep of a lidar carried along T_street_base(time), with its own noise for every `seed`.
  Sweep scan(const std::function<Pose(double)>& T_street_base, double stamp_s, std::uint32_t seed,
             const Lidar& lidar = Lidar()) const;

 private:
  struct Box {
    Eigen::Vector3d low, high;
  };
  struct Pole {
    double x, y, radius, height;
  };

  void addBox(double x0, double x1, double y0, double y1, double height);

  std::vector<Box> boxes_;
  std::vector<Pole> poles_;
};

}  // namespace synthetic
}  // namespace fail_aware
