#include "synthetic_tunnel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/geometry/degree.hpp"

namespace fail_aware {
namespace synthetic {

double Tunnel::profileAt(double x, double y) const {
  if (profile_m == 0.0) return 0.0;
  double sum = 0.0;
  for (int k = 0; k < 12; ++k) {
    const double wave = 2.0 * M_PI / (1.0 + 0.27 * k), heading = 2.4 * k;
    sum += std::sin(wave * (std::cos(heading) * x + std::sin(heading) * y) + 1.7 * k * k);
  }
  return profile_m / 3.0 * sum;
}

Sweep Tunnel::scan(double start_x_m, double speed_mps, double stamp_s, std::uint32_t seed) const {
  Sweep sweep;
  sweep.stamp_s = stamp_s;
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<double> beam_errors;
  std::mt19937 head(7);
  for (int beam = 0; beam < lidar.beams; ++beam) beam_errors.push_back(beam_error_m * noise(head));
  for (int column = 0; column < lidar.columns; ++column) {
    const double fraction = (column + 0.5) / lidar.columns;
    const double yaw = M_PI - 2.0 * M_PI * fraction;
    const double since_stamp_s = lidar.rolling_shutter ? (fraction - 0.5) * lidar.period_s : 0.0;
    const double base_x = start_x_m + speed_mps * (stamp_s + since_stamp_s);
    const Eigen::Vector3d origin = Eigen::Vector3d(base_x, 0.0, 0.0) + lidar.T_base_lidar.translation();
    for (int beam = 0; beam < lidar.beams; ++beam) {
      const double share = static_cast<double>(beam) / std::max(1, lidar.beams - 1);
      const double elevation = (lidar.lowest_deg + share * (lidar.highest_deg - lidar.lowest_deg)) * kDegree;
      const Eigen::Vector3d ray(std::cos(elevation) * std::cos(yaw), std::cos(elevation) * std::sin(yaw),
                                std::sin(elevation));
      const double distance = range(origin, ray, base_x);
      const double error_m = lidar.noise_m * noise(random) + beam_errors[static_cast<std::size_t>(beam)];
      if (!(distance < lidar.max_range_m)) continue;
      sweep.points_lidar.push_back(((distance + error_m) * ray).cast<float>());
      sweep.times_s.push_back(static_cast<float>(since_stamp_s + 0.5 * lidar.period_s));
    }
  }
  return sweep;
}

double Tunnel::range(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray, double base_x) const {
  double nearest = std::numeric_limits<double>::infinity();
  const auto consider = [&](double t) {
    if (t > 0.0) nearest = std::min(nearest, t);
  };
  const auto box = [&](const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    double enter = 0.0, leave = nearest;
    for (int k = 0; k < 3; ++k) {
      const double a = (low[k] - origin[k]) / ray[k], b = (high[k] - origin[k]) / ray[k];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    if (enter <= leave) consider(enter);
  };
  if (ray.z() < 0.0) {
    double t = -origin.z() / ray.z();
    t = (profileAt(origin.x() + t * ray.x(), origin.y() + t * ray.y()) - origin.z()) / ray.z();
    consider(t);
  }
  const auto inTunnel = [&](double t) { return origin.x() + t * ray.x() >= 0.0; };
  if (ray.y() != 0.0) {
    const double t = ((ray.y() > 0.0 ? half_width_m : -half_width_m) - origin.y()) / ray.y();
    if (inTunnel(t) && origin.z() + t * ray.z() <= height_m) consider(t);
  }
  if (ray.z() > 0.0) {
    const double t = (height_m - origin.z()) / ray.z();
    if (inTunnel(t) && std::abs(origin.y() + t * ray.y()) <= half_width_m) consider(t);
  }
  if (origin.x() < 70.0) {
    for (int k = 0; k < 14; ++k) {  // the street before it
      const double side = k % 2 == 0 ? 1.0 : -1.0, x = -105.0 + 8.0 * k, y = side * (7.0 + 0.7 * (k % 5));
      box({x, std::min(y, y + side * 6.0), 0.0}, {x + 4.0 + 0.5 * (k % 4), std::max(y, y + side * 6.0), 7.0});
      const double post = x + 6.0, post_y = side * (5.6 + 0.1 * (k % 6));
      box({post - 0.15, post_y - 0.15, 0.0}, {post + 0.15, post_y + 0.15, 5.0});
    }
  }
  if (lead_car_m > 0.0) {
    box({base_x + lead_car_m, -0.9, 0.2}, {base_x + lead_car_m + 4.2, 0.9, 1.5});
  }
  return nearest;
}

}  // namespace synthetic
}  // namespace fail_aware
