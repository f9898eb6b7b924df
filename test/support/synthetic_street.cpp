#include "synthetic_street.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "core/geometry/degree.hpp"

namespace fail_aware {
namespace synthetic {

namespace {

/// [0, 1), without a pattern.
double scatter(std::uint32_t n) {
  n = (n + 1u) * 2654435761u;
  n ^= n >> 15;
  n *= 2246822519u;
  n ^= n >> 13;
  return static_cast<double>(n >> 8) / static_cast<double>(1u << 24);
}

}  // namespace

Pose Drive::T_street_base(double time_s) const {
  Vector6d twist = Vector6d::Zero();
  twist[0] = speed_mps;
  twist[5] = yaw_rate_rps;
  return T_start * expSe3(time_s * twist);
}

Street::Street() {
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

double Street::range(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double max_range_m) const {
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

Sweep Street::scan(const std::function<Pose(double)>& T_street_base, double stamp_s, std::uint32_t seed,
                   const Lidar& lidar) const {
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

void Street::addBox(double x0, double x1, double y0, double y1, double height) {
  boxes_.push_back({{x0, std::min(y0, y1), 0.0}, {x1, std::max(y0, y1), height}});
}

}  // namespace synthetic
}  // namespace fail_aware
