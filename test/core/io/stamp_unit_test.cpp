#include "core/io/stamp_unit.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace fail_aware::stamp_unit_test {
namespace {

std::string errorOf(const std::vector<double>& stamps) {
  try {
    requireSeconds("times.txt", stamps);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(StampUnit, StepsOfALidarNameTheUnit) {
  EXPECT_EQ(
      errorOf({0.0, 100.0, 200.0}),
      "times.txt: the stamps are 100 apart (median), so they are probably in milliseconds; seconds are needed: divide "
      "them by 1000");
  EXPECT_NE(errorOf({7e12, 7e12 + 5e4, 7e12 + 1e5}).find("in microseconds"), std::string::npos);
  EXPECT_NE(errorOf({1.7e18, 1.7e18 + 1e8, 1.7e18 + 2e8}).find("in nanoseconds"), std::string::npos);
}

TEST(StampUnit, SecondsWithGapsAndStepsBackAreTaken) {
  EXPECT_EQ(errorOf({}), "");
  EXPECT_EQ(errorOf({0.0, 100.0}), "") << "one gap";
  EXPECT_EQ(errorOf({0.0, 0.1, 100.1, 100.2, 100.2, 0.3}), "");
  EXPECT_EQ(errorOf({0.0, 1.5, 3.0}), "") << "a slow lidar";
}

}  // namespace
}  // namespace fail_aware::stamp_unit_test
