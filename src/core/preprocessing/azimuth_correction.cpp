#include "core/preprocessing/azimuth_correction.hpp"

#include <cmath>

#include "core/geometry/degree.hpp"
#include "point_block.hpp"

namespace fail_aware {

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
