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

void VoxelFilter::prepare() {
  if (table_.empty()) resize(1024);
  if (++generation_ == 0) {
    table_.assign(table_.size(), Slot{0, 0});
    generation_ = 1;
  }
  filled_ = 0;
  kept_.clear();
}

void VoxelFilter::resize(std::size_t slots) {
  std::vector<Slot> old(slots, Slot{0, 0});
  old.swap(table_);
  mask_ = slots - 1;
  for (const Slot& slot : old) {
    if (slot.generation == generation_) *find(slot.key) = slot;
  }
}

VoxelFilter::Slot* VoxelFilter::find(VoxelKey key) {
  for (std::size_t i = VoxelHash{}(key)&mask_;; i = (i + 1) & mask_) {
    Slot& slot = table_[i];
    if (slot.generation != generation_ || slot.key == key) return &slot;
  }
}

bool VoxelFilter::insert(VoxelKey key) {
  Slot* slot = find(key);
  if (slot->generation == generation_) return false;
  *slot = {key, generation_};
  if (2 * ++filled_ > table_.size()) resize(2 * table_.size());
  return true;
}

const std::vector<std::uint32_t>& VoxelFilter::select(const std::vector<Eigen::Vector3f>& points, double voxel_size_m,
                                                      double min_range_m, double max_range_m) {
  prepare();
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
  prepare();
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
