#include "core/map/above_ground_points.hpp"

#include <algorithm>
#include <unordered_map>

#include "core/preprocessing/voxel_key.hpp"
#include "core/robust_kernel.hpp"

namespace fail_aware {

AboveGroundPoints findAboveGroundPoints(const std::vector<Eigen::Vector3f>& points,
                                        const AboveGroundPointsParams& params, std::size_t enough) {
  const auto cellOf = [](const Eigen::Vector3f& p, double size_m) {
    return packVoxel(fastFloor(static_cast<double>(p.x()) / size_m), fastFloor(static_cast<double>(p.y()) / size_m), 0);
  };
  std::unordered_map<VoxelKey, float, VoxelHash> lowest;
  for (const Eigen::Vector3f& p : points) {
    const auto [it, added] = lowest.try_emplace(cellOf(p, params.column_m), p.z());
    if (!added) it->second = std::min(it->second, p.z());
  }
  std::vector<std::size_t> above_ground;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f& p = points[i];
    if (static_cast<double>(p.z() - lowest[cellOf(p, params.column_m)]) >= params.min_height_m)
      above_ground.push_back(i);
  }
  const std::size_t stride = 1 + above_ground.size() / enough;
  std::unordered_map<VoxelKey, std::size_t, VoxelHash> numbers;
  AboveGroundPoints result;
  for (std::size_t k = 0; k < above_ground.size(); k += stride) {
    const Eigen::Vector3f& p = points[above_ground[k]];
    const auto number = numbers.try_emplace(cellOf(p, params.cell_m), numbers.size()).first->second;
    result.points.push_back({p.cast<double>(), number});
  }
  result.places = numbers.size();
  result.counts.assign(result.places, 0.0);
  for (const AboveGroundPoint& point : result.points) result.counts[point.place] += 1.0;
  if (!points.empty()) result.ratio = static_cast<double>(above_ground.size()) / static_cast<double>(points.size());
  return result;
}

std::vector<Eigen::Vector3f> pointsWithin(const std::vector<Eigen::Vector3f>& points, double range_m) {
  const auto max_range2 = static_cast<float>(range_m * range_m);
  std::vector<Eigen::Vector3f> within;
  within.reserve(points.size());
  for (const Eigen::Vector3f& p : points) {
    if (p.squaredNorm() <= max_range2) within.push_back(p);
  }
  return within;
}

std::vector<double> votesOfPlaces(const AboveGroundPoints& above_ground, const VoxelMap& map, const Pose& T,
                                  double kernel_m, const std::function<double(const Eigen::Vector3d&)>& unmet) {
  std::vector<double> votes(above_ground.places, 0.0);
  VoxelMap::PointMatch match;
  for (const AboveGroundPoint& point : above_ground.points) {
    const Eigen::Vector3d moved = T * point.position;
    if (map.findNearest(moved, kFarthestInKernels * kernel_m, match)) {
      votes[point.place] += gemanMcClureWeight(match.distance2_m2, kernel_m * kernel_m);
    } else if (unmet) {
      votes[point.place] += unmet(moved);
    }
  }
  for (std::size_t place = 0; place < above_ground.places; ++place) votes[place] /= above_ground.counts[place];
  return votes;
}

}  // namespace fail_aware
