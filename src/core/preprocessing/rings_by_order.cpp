#include "core/preprocessing/rings_by_order.hpp"

#include <array>
#include <cmath>
#include <cstddef>

namespace fail_aware {

namespace {

constexpr std::size_t kBeams = 64;
// In quarter turns: 14 to 28 deg, more than the step back at the rear, less than the step from beam to beam.
constexpr float kStepBack = 0.25f;

/// Quarter turns counter-clockwise from straight ahead, [0, 4]; monotonic in the azimuth, but not linear within a
/// quarter.
float quarterTurns(const Eigen::Vector3f& point) {
  const float share = point.y() / (std::abs(point.x()) + std::abs(point.y()));
  if (point.x() < 0.0f) return 2.0f - share;
  return share < 0.0f ? 4.0f + share : share;
}

}  // namespace

std::vector<std::uint16_t> ringsByOrder(const std::vector<Eigen::Vector3f>& points_lidar) {
  std::vector<std::uint16_t> rings;
  rings.reserve(points_lidar.size());
  std::array<float, kBeams> slope_sum{};  // tangent of the elevation
  std::array<float, kBeams> count{};
  std::size_t beam = 0;
  bool left_the_front = false;  // straight ahead, any beam may have azimuths of 0 and of 360 deg
  float last = 0.0f;
  for (const Eigen::Vector3f& point : points_lidar) {
    const float turns = quarterTurns(point);
    if (left_the_front && turns < last - kStepBack) {
      if (++beam == kBeams) return {};
      left_the_front = false;
    }
    left_the_front |= turns > kStepBack && turns < 4.0f - kStepBack;
    last = turns;
    slope_sum[beam] += point.z() / point.head<2>().norm();
    count[beam] += 1.0f;
    rings.push_back(static_cast<std::uint16_t>(kBeams - 1 - beam));
  }
  if (beam + 1 != kBeams) return {};
  for (std::size_t i = 1; i < kBeams; ++i) {
    if (!(slope_sum[i] / count[i] < slope_sum[i - 1] / count[i - 1])) return {};
  }
  return rings;
}

}  // namespace fail_aware
