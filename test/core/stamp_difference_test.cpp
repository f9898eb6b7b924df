#include "core/stamp_difference.hpp"

#include <gtest/gtest.h>

namespace fail_aware::stamp_difference_test {
namespace {

TEST(StampDifference, IsTheSameWhateverTheClocksZero) {
  int raw_differ = 0;
  for (int i = 1; i < 2000; ++i) {
    const double small_from = 0.103288 * (i - 1), small_to = 0.103288 * i;
    const double large_from = wholeMicroseconds(1317000000.0 + small_from);
    const double large_to = wholeMicroseconds(1317000000.0 + small_to);
    EXPECT_EQ(secondsBetween(small_from, small_to), 0.103288) << i;
    EXPECT_EQ(secondsBetween(large_from, large_to), 0.103288) << i;
    raw_differ += large_to - large_from != small_to - small_from;
  }
  EXPECT_GT(raw_differ, 1000) << "the reason for the rounding";
}

TEST(StampDifference, HasASign) {
  EXPECT_EQ(secondsBetween(2.0, 1.5), -0.5);
  EXPECT_EQ(secondsBetween(1.0, 1.0 + 4e-7), 0.0);
}

}  // namespace
}  // namespace fail_aware::stamp_difference_test
