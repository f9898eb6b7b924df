#include "fail_aware_lidar_odometry/core/cloud/voxel_filter.hpp"

#include <algorithm>
#include <limits>

#include "fail_aware_lidar_odometry/core/cloud/scattered_order.hpp"

namespace fail_aware {

namespace {

VoxelKey keyOf(const Eigen::Vector3f& p, float inverse_size) {
  return packVoxel(fastFloor(static_cast<double>(p.x() * inverse_size)),
                   fastFloor(static_cast<double>(p.y() * inverse_size)),
                   fastFloor(static_cast<double>(p.z() * inverse_size)));
}

}  // namespace

void VoxelFilter::prepare(std::size_t points) {
  std::size_t wanted = 1024;
  while (wanted < points) wanted *= 2;  // kept points are far fewer than points: load stays low
  if (table_.size() < wanted) {
    table_.assign(wanted, Slot{0, 0});
    mask_ = wanted - 1;
    generation_ = 0;
  }
  if (++generation_ == 0) {
    table_.assign(table_.size(), Slot{0, 0});
    generation_ = 1;
  }
  kept_.clear();
}

bool VoxelFilter::insert(VoxelKey key) {
  for (std::size_t i = VoxelHash{}(key)&mask_;; i = (i + 1) & mask_) {
    Slot& slot = table_[i];
    if (slot.generation != generation_) {
      slot = {key, generation_};
      return true;
    }
    if (slot.key == key) return false;
  }
}

const std::vector<std::uint32_t>& VoxelFilter::select(const std::vector<Eigen::Vector3f>& points, double voxel_size_m,
                                                      double min_range_m, double max_range_m) {
  prepare(2 * points.size());
  constexpr double kLargest = std::numeric_limits<float>::max();  // whatever the limit, infinity is beyond it
  const auto min2 = static_cast<float>(min_range_m * min_range_m);
  const auto max2 = static_cast<float>(std::min(max_range_m * max_range_m, kLargest));
  const auto inverse_size = static_cast<float>(1.0 / voxel_size_m);
  const auto count = static_cast<std::uint32_t>(points.size());
  ScatteredOrder order(count);
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t i = order.next();
    const float range2 = points[i].squaredNorm();
    if (!(range2 >= min2 && range2 <= max2)) continue;  // also refuses NaN
    if (voxel_size_m > 0.0 && !insert(keyOf(points[i], inverse_size))) continue;
    kept_.push_back(i);
  }
  return kept_;
}

const std::vector<std::uint32_t>& VoxelFilter::select(const std::vector<Eigen::Vector3f>& points,
                                                      const std::vector<std::uint32_t>& candidates,
                                                      double voxel_size_m) {
  if (&candidates == &kept_) return select(points, std::vector<std::uint32_t>(candidates), voxel_size_m);
  prepare(2 * candidates.size());
  if (voxel_size_m <= 0.0) {
    kept_ = candidates;
    return kept_;
  }
  const auto inverse_size = static_cast<float>(1.0 / voxel_size_m);
  for (const std::uint32_t i : candidates) {
    if (insert(keyOf(points[i], inverse_size))) kept_.push_back(i);
  }
  return kept_;
}

}  // namespace fail_aware
