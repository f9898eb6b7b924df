// A made-up street and a spinning lidar in it, for tests of whole drives: every ray is intersected analytically with
// the ground (z = 0), boxes (houses, garden walls, parked cars) and poles. The street runs along x, from -80 m on to
// 240 m.
// The same seed gives the same points; the scene itself has no seed.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "fail_aware_lidar_odometry/core/cloud/sweep.hpp"
#include "fail_aware_lidar_odometry/core/geometry/degree.hpp"
#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"

namespace fail_aware {
namespace synthetic {

/// Turns clockwise seen from above, begins at the rear, its stamp is the sweep's middle (facing forward), as KITTI's.
struct Lidar {
  int beams = 64;
  int columns = 200;
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

  Pose T_street_base(double time_s) const {
    Vector6d twist = Vector6d::Zero();
    twist[0] = speed_mps;
    twist[5] = yaw_rate_rps;
    return T_start * expSe3(time_s * twist);
  }
  /// What odometry that began at `begin_s` should say.
  Pose T_odom_base(double time_s, double begin_s = 0.0) const {
    return T_street_base(begin_s).inverse() * T_street_base(time_s);
  }
};

class Street {
 public:
  Street() {
    for (const double side : {-1.0, 1.0}) {
      double x = side > 0.0 ? -80.0 : -77.0;
      for (std::uint32_t i = side > 0.0 ? 0 : 100; x < 240.0; ++i) {
        const double length = 6.0 + 7.0 * scatter(4 * i), setback = 9.0 + 4.0 * scatter(4 * i + 1);
        const double gap = 1.5 + 4.0 * scatter(4 * i + 2);
        addBox(x, x + length, side * setback, side * (setback + 8.0), 4.0 + 5.0 * scatter(4 * i + 3));
        addBox(x + length, x + length + gap, side * (setback + 1.0), side * (setback + 1.3), 1.6);
        const double car = x + length * scatter(4 * i + 7);
        if (i % 3 != 0) addBox(car, car + 4.2, side * 5.5, side * 7.3, 1.5);
        poles_.push_back({x + gap * scatter(4 * i + 5), side * (7.8 + scatter(4 * i + 6)), 0.12, 6.0});
        x += length + gap;
      }
    }
  }

  /// Along a unit direction; infinity if there is nothing within max_range_m.
  double range(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double max_range_m) const {
    double nearest = max_range_m;
    bool hit = false;
    const auto consider = [&](double t) {
      if (t > 1e-6 && t < nearest) {
        nearest = t;
        hit = true;
      }
    };
    if (direction.z() < 0.0) consider(-origin.z() / direction.z());
    for (const Box& box : boxes_) {
      if (box.low.x() > origin.x() + nearest || box.high.x() < origin.x() - nearest) continue;
      double enter = 0.0, leave = nearest;
      for (int k = 0; k < 3; ++k) {
        const double a = (box.low[k] - origin[k]) / direction[k], b = (box.high[k] - origin[k]) / direction[k];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
      }
      if (enter <= leave) consider(enter);
    }
    for (const Pole& pole : poles_) {
      const double dx = origin.x() - pole.x, dy = origin.y() - pole.y;
      if (std::abs(dx) > nearest + pole.radius) continue;
      const double a = direction.x() * direction.x() + direction.y() * direction.y();
      const double b = dx * direction.x() + dy * direction.y();
      const double discriminant = b * b - a * (dx * dx + dy * dy - pole.radius * pole.radius);
      if (discriminant < 0.0 || a <= 0.0) continue;
      const double t = (-b - std::sqrt(discriminant)) / a;
      if (origin.z() + t * direction.z() < pole.height) consider(t);
    }
    return hit ? nearest : std::numeric_limits<double>::infinity();
  }

  /// The sweep of a lidar carried along T_street_base(time), with its own noise for every `seed`.
  Sweep scan(const std::function<Pose(double)>& T_street_base, double stamp_s, std::uint32_t seed,
             const Lidar& lidar = Lidar()) const {
    Sweep sweep;
    sweep.stamp_s = stamp_s;
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0.0, 1.0);
    for (int column = 0; column < lidar.columns; ++column) {
      const double fraction = (column + 0.5) / lidar.columns;
      const double yaw = M_PI - 2.0 * M_PI * fraction;
      const double since_stamp_s = lidar.rolling_shutter ? (fraction - 0.5) * lidar.period_s : 0.0;
      const Pose T_street_lidar = T_street_base(stamp_s + since_stamp_s) * lidar.T_base_lidar;
      for (int beam = 0; beam < lidar.beams; ++beam) {
        const double share = static_cast<double>(beam) / std::max(1, lidar.beams - 1);
        const double elevation = (lidar.lowest_deg + share * (lidar.highest_deg - lidar.lowest_deg)) * kDegree;
        const Eigen::Vector3d ray(std::cos(elevation) * std::cos(yaw), std::cos(elevation) * std::sin(yaw),
                                  std::sin(elevation));
        const double distance = range(T_street_lidar.translation(), T_street_lidar.linear() * ray, lidar.max_range_m);
        const double error_m = lidar.noise_m * noise(random);
        if (!std::isfinite(distance)) continue;
        sweep.points_lidar.push_back(((distance + error_m) * ray).cast<float>());
        sweep.intensities.push_back(0.5f);
        sweep.rings.push_back(static_cast<std::uint16_t>(beam));
      }
    }
    return sweep;
  }

 private:
  struct Box {
    Eigen::Vector3d low, high;
  };
  struct Pole {
    double x, y, radius, height;
  };

  /// [0, 1), without a pattern.
  static double scatter(std::uint32_t n) {
    n = (n + 1u) * 2654435761u;
    n ^= n >> 15;
    n *= 2246822519u;
    n ^= n >> 13;
    return static_cast<double>(n >> 8) / static_cast<double>(1u << 24);
  }

  void addBox(double x0, double x1, double y0, double y1, double height) {
    boxes_.push_back({{x0, std::min(y0, y1), 0.0}, {x1, std::max(y0, y1), height}});
  }

  std::vector<Box> boxes_;
  std::vector<Pole> poles_;
};

}  // namespace synthetic
}  // namespace fail_aware
