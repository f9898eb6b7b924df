// The terrain: a smooth height over the plane, hills of 120 to 900 m, as a sum of waves. The road follows it.
//
// World frame: x, y, z up, m. No failure modes. Cost: eight sines, about 0.1 us; 0.2 s and 1 MB for a terrain.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace fail_aware {

class Terrain {
 public:
  /// `grade`: root mean square of the slope.
  Terrain(std::uint64_t seed, double grade);

  double height(const Eigen::Vector2d& p) const;
  Eigen::Vector2d gradient(const Eigen::Vector2d& p) const;

  /// Bumps of 5 to 14 m with a standard deviation of 1, for the ground beside the road.
  double bumps(const Eigen::Vector2d& p) const;
  /// The road's unevenness (m, a few mm). It shakes the vehicle, and the lidar sees it (uneven_road.hpp).
  double roadRoughness(const Eigen::Vector2d& p) const;

 private:
  struct Wave {
    Eigen::Vector2d k;  ///< rad/m
    double amplitude;
    double phase;
  };
  template <std::size_t N>
  static double sum(const std::array<Wave, N>& waves, const Eigen::Vector2d& p);

  std::array<Wave, 8> hills_;
  std::array<Wave, 6> bumps_;
  std::vector<float> roughness_m_;  ///< on a square grid that repeats itself
};

}  // namespace fail_aware
