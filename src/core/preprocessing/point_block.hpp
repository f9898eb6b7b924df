// Points in blocks of coordinate arrays, so that Eigen vectorizes the arithmetic with any compiler flags.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <vector>

namespace fail_aware {

struct PointBlock {
  static constexpr std::size_t kSize = 64;
  using Array = Eigen::Array<float, static_cast<int>(kSize), 1>;

  Array x = Array::Zero();
  Array y = Array::Zero();
  Array z = Array::Zero();

  void load(const Eigen::Vector3f* points, std::size_t count) {
    const float* from = points->data();
    for (std::size_t i = 0; i < count; ++i, from += 3) {
      x.data()[i] = from[0];
      y.data()[i] = from[1];
      z.data()[i] = from[2];
    }
  }

  void store(Eigen::Vector3f* points, std::size_t count) const {
    float* to = points->data();
    for (std::size_t i = 0; i < count; ++i, to += 3) {
      to[0] = x.data()[i];
      to[1] = y.data()[i];
      to[2] = z.data()[i];
    }
  }
};

/// Calls work(first, count) for consecutive ranges of at most PointBlock::kSize out of `size`.
template <class Work>
void forEachBlock(std::size_t size, Work&& work) {
  for (std::size_t first = 0; first < size; first += PointBlock::kSize) {
    work(first, std::min(PointBlock::kSize, size - first));
  }
}

/// Calls change(block) for all points, block by block, and keeps what it makes of them.
template <class Change>
void changeBlocks(std::vector<Eigen::Vector3f>& points, Change&& change) {
  PointBlock block;
  forEachBlock(points.size(), [&](std::size_t first, std::size_t count) {
    block.load(&points[first], count);
    change(block);
    block.store(&points[first], count);
  });
}

}  // namespace fail_aware
