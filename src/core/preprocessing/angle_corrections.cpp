#include "core/preprocessing/angle_corrections.hpp"

#include <cmath>

#include "core/geometry/degree.hpp"
#include "point_block.hpp"

namespace fail_aware {

void correctVerticalAngle(double angle_rad, std::vector<Eigen::Vector3f>& points_lidar) {
  if (angle_rad == 0.0) return;
  const float c = static_cast<float>(std::cos(angle_rad));
  const float s = static_cast<float>(std::sin(angle_rad));

  // With the horizontal distance h: (h, z) is rotated by the angle, and (x, y) scales with h.
  changeBlocks(points_lidar, [&](PointBlock& p) {
    const PointBlock::Array h = (p.x * p.x + p.y * p.y).sqrt().max(1e-6f);
    const PointBlock::Array scale = c - s * p.z / h;
    p.z = c * p.z + s * h;
    p.x *= scale;
    p.y *= scale;
  });
}

void correctAzimuth(const AzimuthCorrectionParams& params, std::vector<Eigen::Vector3f>& points_lidar) {
  if (params.angle_deg == 0.0) return;
  const double angle_rad = params.angle_deg * kDegree;
  const float c = static_cast<float>(std::cos(angle_rad));
  const float s = static_cast<float>(std::sin(angle_rad));
  changeBlocks(points_lidar, [&](PointBlock& p) {
    const PointBlock::Array x = c * p.x - s * p.y;
    p.y = s * p.x + c * p.y;
    p.x = x;
  });
}

}  // namespace fail_aware
