// A made-up tunnel and a spinning lidar in it: smooth walls and ceiling along x, a car ahead that keeps its distance, a
// road with or without relief. Before x = 0 there is a street with houses and posts beside the road instead of walls.
// The same seed gives the same points.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "fail_aware_lidar_odometry/sweep.hpp"
#include "synthetic_street.hpp"

namespace fail_aware {
namespace synthetic {

struct Tunnel {
  double half_width_m = 5.0, height_m = 6.0;
  double profile_m = 0.0;      ///< amplitude of the road's unevenness, waves of 1 to 4 m
  double lead_car_m = 18.0;    ///< distance to the car ahead; 0: none
  double beam_error_m = 0.02;  ///< of the ranges of one beam, the same all the time
  Lidar lidar = [] {
    Lidar l;
    l.columns = 400;
    return l;
  }();

  double profileAt(double x, double y) const;

  /// base_link drives along x at `speed_mps` and is at start_x_m at time 0.
  Sweep scan(double start_x_m, double speed_mps, double stamp_s, std::uint32_t seed) const;

 private:
  double range(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray, double base_x) const;
};

}  // namespace synthetic
}  // namespace fail_aware
