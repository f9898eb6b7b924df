#include "core/preprocessing/voxel_filter.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "core/preprocessing/scattered_order.hpp"

namespace fail_aware {

namespace {

constexpr VoxelKey kOutOfRange = ~VoxelKey{0};  // a voxel's key has 63 bits
constexpr std::size_t kAhead = 32;              // slots that are prefetched before the first of them is needed

VoxelKey keyOf(const Eigen::Vector3f& p, float inverse_size) {
  return packVoxel(fastFloor(p.x() * inverse_size), fastFloor(p.y() * inverse_size), fastFloor(p.z() * inverse_size));
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
                                                      double min_range_m, double max_range_m, Order order) {
  prepare();
  constexpr double kLargest = std::numeric_limits<float>::max();  // infinity is beyond it for any max_range_m
  const auto min2 = static_cast<float>(min_range_m * min_range_m);
  const auto max2 = static_cast<float>(std::min(max_range_m * max_range_m, kLargest));
  const auto inverse_size = static_cast<float>(1.0 / voxel_size_m);
  const auto count = static_cast<std::uint32_t>(points.size());
  keys_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const float range2 = points[i].squaredNorm();
    const bool in_range = range2 >= min2 && range2 <= max2;  // false for NaN
    keys_[i] = in_range ? keyOf(points[i], inverse_size) : kOutOfRange;
  }
  ScatteredOrder scattered(count);
  std::array<std::uint32_t, kAhead> ahead;
  for (std::uint32_t k = 0; k < count;) {
    std::size_t found = 0;
    for (; k < count && found < kAhead; ++k) {
      const std::uint32_t i = order == Order::kScattered ? scattered.next() : k;
      if (keys_[i] != kOutOfRange) ahead[found++] = i;
    }
    for (std::size_t j = 0; j < found; ++j) __builtin_prefetch(&table_[VoxelHash{}(keys_[ahead[j]]) & mask_], 1);
    for (std::size_t j = 0; j < found; ++j) {
      if (insert(keys_[ahead[j]])) kept_.push_back(ahead[j]);
    }
  }
  return kept_;
}

}  // namespace fail_aware
