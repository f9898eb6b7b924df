// Downsampling: one point per voxel, the first one visited: by default in an order without preferred direction
// (scattered_order.hpp).
//
// A measured point (instead of a centroid) does not mix surfaces and keeps its time.
// Cost: one probe of a flat table per point, about 10 ns; no allocation once the buffers have grown. Not thread-safe:
// use one filter per thread.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/preprocessing/voxel_key.hpp"

namespace fail_aware {

class VoxelFilter {
 public:
  enum class Order { kScattered, kAsGiven };

  /// Indices of the points kept, in the order visited. Points nearer than min_range_m or farther than max_range_m from
  /// the origin, and points that are not finite, are left out. voxel_size_m > 0.
  const std::vector<std::uint32_t>& select(const std::vector<Eigen::Vector3f>& points, double voxel_size_m,
                                           double min_range_m, double max_range_m, Order order = Order::kScattered);

 private:
  struct Slot {
    VoxelKey key;
    std::uint32_t generation;
  };
  void prepare();
  void resize(std::size_t slots);
  Slot* find(VoxelKey key);  ///< the slot of the key, or the free slot for it
  bool insert(VoxelKey key);

  std::vector<Slot> table_;  ///< at most half full; no larger, so that it stays in the cache
  std::size_t filled_ = 0;
  std::size_t mask_ = 0;
  std::uint32_t generation_ = 0;
  std::vector<VoxelKey> keys_;  ///< of the points
  std::vector<std::uint32_t> kept_;
};

}  // namespace fail_aware
