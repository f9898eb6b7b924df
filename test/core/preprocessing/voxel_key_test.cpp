#include "core/preprocessing/voxel_key.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <unordered_set>

namespace fail_aware::voxel_key_test {
namespace {

TEST(VoxelKeyTest, FastFloorIsFloor) {
  for (double v = -50.0; v < 50.0; v += 0.125) EXPECT_EQ(fastFloor(v), static_cast<int>(std::floor(v))) << v;
  EXPECT_EQ(fastFloor(-1e-12), -1);
  EXPECT_EQ(fastFloor(-0.0), 0);
  EXPECT_EQ(fastFloor(std::nextafter(3.0, 0.0)), 2);
  EXPECT_EQ(fastFloor(2e9 + 0.5), 2000000000);
  EXPECT_EQ(fastFloor(-2e9 - 0.5), -2000000001);
}

TEST(VoxelKeyTest, KeysOfDifferentVoxelsDiffer) {
  std::set<VoxelKey> keys;
  int voxels = 0;
  for (const int x : {-1048575, -2, -1, 0, 1, 2, 1048575}) {
    for (const int y : {-1048575, -2, -1, 0, 1, 2, 1048575}) {
      for (const int z : {-1048575, -2, -1, 0, 1, 2, 1048575}) {
        keys.insert(packVoxel(x, y, z));
        ++voxels;
      }
    }
  }
  EXPECT_EQ(static_cast<int>(keys.size()), voxels);
}

TEST(VoxelKeyTest, KeysWrapBeyondTwentyOneBits) {
  EXPECT_EQ(packVoxel(1 << 21, 0, 0), packVoxel(0, 0, 0));
  EXPECT_EQ(packVoxel(5, -3 - (1 << 21), 7), packVoxel(5, -3, 7));
}

TEST(VoxelKeyTest, NoKeyHasAllBitsSet) { EXPECT_NE(packVoxel(-1, -1, -1), ~VoxelKey{0}); }

TEST(VoxelKeyTest, HashSpreadsNeighboursOverTheLowBits) {
  std::unordered_set<std::size_t> slots;
  for (int x = -16; x < 16; ++x) {
    for (int y = -16; y < 16; ++y) {
      for (int z = -2; z < 2; ++z) slots.insert(VoxelHash{}(packVoxel(x, y, z)) & 0xFFFF);
    }
  }
  // 4096 keys thrown at random into 65536 slots meet 3970 of them
  EXPECT_GT(slots.size(), 3700u);
}

}  // namespace
}  // namespace fail_aware::voxel_key_test
