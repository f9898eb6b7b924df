// How much of the revolution a cloud covers: the ratio of the azimuth's sectors of 5 deg that hold points. Not in the
// paper. Cost: one arc tangent a point.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace fail_aware {

/// points: x forward, y left, seen from the lidar (or from near it). Every `stride`-th one is looked at. 0..1; 0
/// without points.
double azimuthCoverage(const std::vector<Eigen::Vector3f>& points, std::size_t stride = 1);

}  // namespace fail_aware
