// Integer coordinates of a cubic voxel, packed into 64 bits.
#pragma once

#include <cstddef>
#include <cstdint>

namespace fail_aware {

using VoxelKey = std::uint64_t;

/// floor() without a library call; exact for |v| < 2^31.
inline std::int32_t fastFloor(double v) {
  const auto i = static_cast<std::int32_t>(v);
  return i - (static_cast<double>(i) > v ? 1 : 0);
}

inline std::int32_t fastFloor(float v) {
  const auto i = static_cast<std::int32_t>(v);
  return i - (static_cast<float>(i) > v ? 1 : 0);
}

/// 21 bits per axis: +-1,048,575 voxels, 500 km at 0.5 m; beyond that keys wrap.
inline VoxelKey packVoxel(std::int32_t x, std::int32_t y, std::int32_t z) {
  constexpr std::uint64_t mask = (1u << 21) - 1;
  return ((static_cast<std::uint64_t>(x) & mask) << 42) | ((static_cast<std::uint64_t>(y) & mask) << 21) |
         (static_cast<std::uint64_t>(z) & mask);
}

/// Spreads a key over all bits (Fibonacci hashing with one xor-shift), so that a table can use the low bits.
struct VoxelHash {
  std::size_t operator()(VoxelKey key) const {
    const std::uint64_t h = key * 0x9E3779B97F4A7C15ull;
    return static_cast<std::size_t>(h ^ (h >> 32));
  }
};

}  // namespace fail_aware
