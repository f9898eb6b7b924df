#include "core/preprocessing/scattered_order.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace fail_aware::scattered_order_test {
namespace {

TEST(ScatteredOrder, EveryIndexOnce) {
  for (const std::uint32_t n : {1u, 2u, 3u, 4u, 10u, 97u, 1024u, 30030u, 120000u}) {
    ScatteredOrder order(n);
    std::set<std::uint32_t> seen;
    for (std::uint32_t i = 0; i < n; ++i) seen.insert(order.next());
    EXPECT_EQ(seen.size(), n);
    EXPECT_EQ(*seen.rbegin(), n - 1);
  }
}

TEST(ScatteredOrder, PrefersNoDirection) {
  // of every ten neighbours the first met is as often any of them
  constexpr std::uint32_t kPoints = 120000, kCell = 10;
  ScatteredOrder order(kPoints);
  std::set<std::uint32_t> cells;
  double sum = 0.0;
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    const std::uint32_t index = order.next();
    if (cells.insert(index / kCell).second) sum += index % kCell;
  }
  EXPECT_NEAR(sum / static_cast<double>(cells.size()), 0.5 * (kCell - 1), 0.2);
}

}  // namespace
}  // namespace fail_aware::scattered_order_test
