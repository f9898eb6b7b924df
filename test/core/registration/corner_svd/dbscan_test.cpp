#include "core/registration/corner_svd/dbscan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

namespace fail_aware::dbscan_test {
namespace {

using Points = std::vector<Eigen::Vector2f>;

double uniform(std::mt19937& generator, double low, double high) {
  return low + (high - low) * static_cast<double>(static_cast<std::uint32_t>(generator())) / 4294967296.0;
}

bool within(const Eigen::Vector2f& a, const Eigen::Vector2f& b, double eps) {
  return (a.cast<double>() - b.cast<double>()).squaredNorm() <= eps * eps;
}

std::vector<bool> bruteForceCores(const Points& points, double eps, int min_points, const std::vector<int>& weights) {
  std::vector<bool> cores;
  for (const Eigen::Vector2f& p : points) {
    int count = 0;
    for (std::size_t j = 0; j < points.size(); ++j) count += within(p, points[j], eps) ? weights[j] : 0;
    cores.push_back(count >= min_points);
  }
  return cores;
}

// Textbook growth of clusters over cores; border points keep -2 for "some cluster".
std::vector<int> bruteForceLabels(const Points& points, double eps, const std::vector<bool>& cores) {
  std::vector<int> labels(points.size(), -1);
  int next = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!cores[i] || labels[i] >= 0) continue;
    std::vector<std::size_t> open{i};
    labels[i] = next;
    while (!open.empty()) {
      const std::size_t p = open.back();
      open.pop_back();
      for (std::size_t q = 0; q < points.size(); ++q) {
        if (!within(points[p], points[q], eps) || labels[q] >= 0) continue;
        if (!cores[q]) {
          labels[q] = -2;
          continue;
        }
        labels[q] = next;
        open.push_back(q);
      }
    }
    ++next;
  }
  return labels;
}

void expectLikeBruteForce(const Points& points, double eps, int min_points, std::vector<int> weights) {
  const std::vector<int> labels = dbscan2d(points, eps, min_points, weights);
  if (weights.empty()) weights.assign(points.size(), 1);
  const std::vector<bool> cores = bruteForceCores(points, eps, min_points, weights);
  const std::vector<int> expected = bruteForceLabels(points, eps, cores);
  ASSERT_EQ(labels.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (expected[i] != -2) {
      EXPECT_EQ(labels[i], expected[i]) << "point " << i;
      continue;
    }
    bool of_a_core_in_reach = false;
    for (std::size_t j = 0; j < points.size(); ++j) {
      of_a_core_in_reach |= cores[j] && within(points[i], points[j], eps) && labels[j] == labels[i];
    }
    EXPECT_TRUE(of_a_core_in_reach) << "border point " << i;
  }
}

Points walls(std::uint32_t seed) {
  std::mt19937 generator(seed);
  Points points;
  for (int wall = 0; wall < 6; ++wall) {
    const double x = uniform(generator, -9, 9), y = uniform(generator, -9, 9), angle = uniform(generator, 0, 6.28);
    for (int i = 0; i < 70; ++i) {
      const double s = uniform(generator, 0, 5), noise = uniform(generator, -0.2, 0.2);
      points.emplace_back(static_cast<float>(x + s * std::cos(angle) + noise),
                          static_cast<float>(y + s * std::sin(angle)));
    }
  }
  for (int i = 0; i < 150; ++i) {
    points.emplace_back(static_cast<float>(uniform(generator, -10, 10)),
                        static_cast<float>(uniform(generator, -10, 10)));
  }
  return points;
}

TEST(Dbscan, EqualsBruteForce) {
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    for (const int min_points : {1, 4, 9, 20}) expectLikeBruteForce(walls(seed), 0.7, min_points, {});
  }
}

TEST(Dbscan, EqualsBruteForceWithWeights) {
  std::mt19937 generator(5);
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const Points points = walls(seed);
    std::vector<int> weights;
    for (std::size_t i = 0; i < points.size(); ++i) weights.push_back(1 + static_cast<int>(generator() % 9));
    expectLikeBruteForce(points, 0.5, 25, weights);
  }
}

TEST(Dbscan, PointsOnALatticeExactlyEpsApartAreConnected) {
  Points points;
  for (int i = 0; i < 12; ++i) {
    for (int j = 0; j < 3; ++j) points.emplace_back(0.5F * static_cast<float>(i) - 2.0F, 0.5F * static_cast<float>(j));
  }
  expectLikeBruteForce(points, 0.5, 3, {});
  EXPECT_EQ(dbscan2d(points, 0.5, 3), std::vector<int>(points.size(), 0));
  EXPECT_EQ(dbscan2d(points, 0.4999, 2), std::vector<int>(points.size(), -1));
}

TEST(Dbscan, WeightsCountAsPoints) {
  const Points points{{0, 0}, {0.3F, 0}, {5, 5}, {9, 9}};
  EXPECT_EQ(dbscan2d(points, 0.7, 50, {30, 20, 50, 49}), (std::vector<int>{0, 0, 1, -1}));
}

TEST(Dbscan, ClustersAreNumberedByTheirFirstCorePoint) {
  EXPECT_EQ(dbscan2d({{50, 50}, {-50, -50}, {50, 50.1F}, {0, 0}, {-50, -50.1F}}, 0.7, 2),
            (std::vector<int>{0, 1, 0, -1, 1}));
}

TEST(Dbscan, NothingBadComesOfBadInput) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(dbscan2d({}, 0.7, 5).empty());
  EXPECT_EQ(dbscan2d({{nan, 0}, {0, infinity}, {1, 1}, {3e38F, 0}}, 0.7, 1), (std::vector<int>{-1, -1, 0, -1}));
}

}  // namespace
}  // namespace fail_aware::dbscan_test
