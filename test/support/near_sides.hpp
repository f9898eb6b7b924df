// Round posts along a straight road, of which a sensor sees the near sides.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <vector>

#include "core/geometry/pose.hpp"

namespace fail_aware {

/// What a sensor at `T_odom_sensor` sees of posts that are 0.12 m thick and stand at y = +-5 m, from z = -1 to 0.5 m,
/// in its frame. Ranges scatter by 2 cm.
inline std::vector<Eigen::Vector3f> nearSidesSeenAt(const Pose& T_odom_sensor) {
  constexpr double kRadius_m = 0.06;
  std::mt19937 random(7);
  std::normal_distribution<double> range_error_m(0.0, 0.02);
  std::vector<Eigen::Vector3f> points;
  for (double x = -40.0; x <= 60.0; x += 5.0) {
    for (const double y : {-5.0, 5.0}) {
      const Eigen::Vector2d towards_sensor =
          (T_odom_sensor.translation().head<2>() - Eigen::Vector2d(x, y)).normalized();
      const Eigen::Vector2d across(-towards_sensor.y(), towards_sensor.x());
      for (double z = -1.0; z <= 0.51; z += 0.1) {
        for (const double beam : {-0.6, 0.0, 0.6}) {
          const double depth_m = kRadius_m * std::sqrt(1.0 - beam * beam) + range_error_m(random);
          const Eigen::Vector2d p = Eigen::Vector2d(x, y) + depth_m * towards_sensor + beam * kRadius_m * across;
          points.push_back((T_odom_sensor.inverse() * Eigen::Vector3d(p.x(), p.y(), z)).cast<float>());
        }
      }
    }
  }
  return points;
}

}  // namespace fail_aware
