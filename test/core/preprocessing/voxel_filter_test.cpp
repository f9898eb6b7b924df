#include "core/preprocessing/voxel_filter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "core/preprocessing/scattered_order.hpp"

namespace fail_aware::voxel_filter_test {
namespace {

using Points = std::vector<Eigen::Vector3f>;
using Indices = std::vector<std::uint32_t>;

constexpr double kFar = 1000.0;

Points randomPoints(std::size_t count, float half_width, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> coordinate(-half_width, half_width);
  Points points(count);
  for (Eigen::Vector3f& p : points) p = {coordinate(generator), coordinate(generator), coordinate(generator)};
  return points;
}

Indices ascending(Indices indices) {
  std::sort(indices.begin(), indices.end());
  return indices;
}

TEST(VoxelFilter, KeepsOnePointOfEachVoxelTheFirstOneAsGiven) {
  VoxelFilter filter;
  const Points points = {
      {2.6f, 0.1f, 0.1f}, {0.9f, 0.9f, 0.9f}, {2.1f, 0.9f, 0.9f}, {0.1f, 0.1f, 0.1f}, {0.1f, 1.1f, 0.1f}};
  EXPECT_EQ(filter.select(points, 1.0, 0.0, kFar).size(), 3u);
  EXPECT_EQ(filter.select(points, 1.0, 0.0, kFar, VoxelFilter::Order::kAsGiven), (Indices{0, 1, 4}));
  EXPECT_EQ(filter.select({points.rbegin(), points.rend()}, 1.0, 0.0, kFar, VoxelFilter::Order::kAsGiven),
            (Indices{0, 1, 2}));
}

TEST(VoxelFilter, KeepsNoSideOfAVoxelMoreOften) {
  // a wall seen by a beam that always comes from the left
  Points points;
  for (int i = 0; i < 100000; ++i) points.emplace_back(0.001f * static_cast<float>(i), 20.0f, 0.0f);
  VoxelFilter filter;
  double sum = 0.0;
  const Indices kept = filter.select(points, 0.3, 0.0, kFar);
  for (const std::uint32_t i : kept) sum += std::fmod(static_cast<double>(points[i].x()), 0.3) / 0.3;
  EXPECT_NEAR(sum / static_cast<double>(kept.size()), 0.5, 0.05);
}

TEST(VoxelFilter, VoxelsDoNotMeetAtZero) {
  VoxelFilter filter;
  Points points;
  for (const float x : {-0.1f, 0.1f}) {
    for (const float y : {-0.1f, 0.1f}) {
      for (const float z : {-0.1f, 0.1f}) points.emplace_back(x, y, z);
    }
  }
  EXPECT_EQ(filter.select(points, 1.0, 0.0, kFar).size(), 8u);
  EXPECT_EQ(filter.select({{-0.1f, -0.1f, -0.1f}, {-0.9f, -0.9f, -0.9f}, {-1.1f, -0.9f, -0.9f}}, 1.0, 0.0, kFar).size(),
            2u);
}

TEST(VoxelFilter, AgreesWithASetOfVoxels) {
  VoxelFilter filter;
  const Points points = randomPoints(20000, 20.0f, 1);
  for (const double size : {0.25, 1.0, 2.5}) {
    std::set<std::array<int, 3>> seen;
    Indices expected;
    ScatteredOrder order(static_cast<std::uint32_t>(points.size()));
    for (std::size_t k = 0; k < points.size(); ++k) {
      const std::uint32_t i = order.next();
      std::array<int, 3> voxel;
      for (int axis = 0; axis < 3; ++axis) {
        voxel[static_cast<std::size_t>(axis)] =
            static_cast<int>(std::floor(points[i][axis] * static_cast<float>(1.0 / size)));
      }
      if (seen.insert(voxel).second) expected.push_back(i);
    }
    EXPECT_EQ(filter.select(points, size, 0.0, kFar), expected) << size;
  }
}

TEST(VoxelFilter, TheSameWhateverItWasUsedForBefore) {
  VoxelFilter used;
  const Points points = randomPoints(5000, 10.0f, 2);
  const Indices fresh = VoxelFilter().select(points, 0.7, 2.0, 9.0);
  for (unsigned round = 0; round < 5; ++round) {
    used.select(randomPoints(3000 * round, 30.0f, round), 0.3, 0.0, kFar);
    EXPECT_EQ(used.select(points, 0.7, 2.0, 9.0), fresh) << round;
  }
}

TEST(VoxelFilter, RangeLimitsAreInclusive) {
  VoxelFilter filter;
  const Points points = {{0.0f, 0.0f, 0.0f},  {2.99f, 0.0f, 0.0f}, {0.0f, 3.0f, 0.0f},
                         {0.0f, 0.0f, -5.0f}, {6.0f, 8.0f, 0.0f},  {6.0f, 8.1f, 0.0f}};
  EXPECT_EQ(ascending(filter.select(points, 0.1, 3.0, 10.0)), (Indices{2, 3, 4}));
}

TEST(VoxelFilter, RefusesWhatIsNotFinite) {
  VoxelFilter filter;
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  const Points points = {{nan, 1.0f, 1.0f},      {1.0f, nan, 1.0f},  {1.0f, 1.0f, nan},      {infinity, 1.0f, 1.0f},
                         {1.0f, -infinity, nan}, {1.0f, 1.0f, 1.0f}, {1.0f, -infinity, 1.0f}};
  for (const double max_range : {kFar, 1e30, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(filter.select(points, 0.5, 0.0, max_range), (Indices{5})) << max_range;
  }
}

TEST(VoxelFilter, NothingOfNothing) { EXPECT_TRUE(VoxelFilter().select({}, 1.0, 0.0, kFar).empty()); }

TEST(VoxelFilter, ManyVoxelsFillNoTable) {
  VoxelFilter filter;
  Points points;
  for (int x = 0; x < 50; ++x) {
    for (int y = 0; y < 50; ++y) {
      for (int z = 0; z < 20; ++z) points.push_back(Eigen::Vector3i(x, y, z).cast<float>());
    }
  }
  EXPECT_EQ(filter.select(points, 1.0, 0.0, kFar).size(), points.size());
}

}  // namespace
}  // namespace fail_aware::voxel_filter_test
