#include "core/moving_median.hpp"

#include <gtest/gtest.h>

namespace fail_aware::moving_median_test {
namespace {

TEST(MovingMedian, IsTheMiddleOneOfTheLastValues) {
  MovingMedian median(3);
  EXPECT_EQ(median.median(), 0.0);
  median.add(5.0);
  EXPECT_EQ(median.median(), 5.0);
  median.add(1.0);
  EXPECT_EQ(median.median(), 5.0) << "the upper one of two";
  EXPECT_FALSE(median.isFull());
  median.add(2.0);
  EXPECT_EQ(median.median(), 2.0);
  EXPECT_TRUE(median.isFull());
  median.add(3.0);
  EXPECT_EQ(median.median(), 2.0);
  median.add(4.0);
  EXPECT_EQ(median.median(), 3.0) << "5 and 1 are forgotten";
  EXPECT_EQ(median.size(), 3u);
  median.clear();
  EXPECT_EQ(median.size(), 0u);
}

}  // namespace
}  // namespace fail_aware::moving_median_test
