#include "core/initial_guess/occlusion_image.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/degree.hpp"

namespace fail_aware {

namespace {

// Size of a pixel. With half or twice the azimuth the speed is found on as many of 120 highway starts within one.
constexpr double kAzimuthStep_rad = 1.0 * kDegree, kElevationStep_rad = 1.5 * kDegree;
constexpr std::size_t kAzimuths = 361, kElevations = 121;
constexpr double kBehind_m = 1.0;  // deeper than one surface at a slant within a pixel

}  // namespace

OcclusionImage::OcclusionImage(const AboveGroundPoints& things, const Eigen::Vector3d& lidar_position_m)
    : lidar_position_m_(lidar_position_m), nearest_m_(kAzimuths * kElevations, std::numeric_limits<float>::max()) {
  for (const AboveGroundPoint& thing : things.points) {
    const Direction direction = directionOf(thing.position);
    float& nearest_m = nearest_m_[direction.pixel];
    nearest_m = std::min(nearest_m, static_cast<float>(direction.range_m));
  }
}

bool OcclusionImage::hides(const Eigen::Vector3d& point) const {
  if (nearest_m_.empty()) return false;
  const Direction direction = directionOf(point);
  return static_cast<double>(nearest_m_[direction.pixel]) < direction.range_m - kBehind_m;
}

OcclusionImage::Direction OcclusionImage::directionOf(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d ray = point - lidar_position_m_;
  const double azimuth_rad = std::atan2(ray.y(), ray.x()) + M_PI;
  const double elevation_rad = std::atan2(ray.z(), ray.head<2>().norm()) + M_PI_2;
  const auto column = static_cast<std::size_t>(azimuth_rad / kAzimuthStep_rad);
  const auto row = static_cast<std::size_t>(elevation_rad / kElevationStep_rad);
  return {row * kAzimuths + column, ray.norm()};
}

}  // namespace fail_aware
