#include "fail_aware_lidar_odometry/core/evaluation/nelder_mead.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fail_aware {
namespace {

TEST(NelderMead, FindsRosenbrocksMinimum) {
  const auto rosenbrock = [](const std::vector<double>& x) {
    return std::pow(1.0 - x[0], 2) + 100.0 * std::pow(x[1] - x[0] * x[0], 2);
  };
  const NelderMeadResult result = nelderMead(rosenbrock, {-1.2, 1.0}, 0.5);
  EXPECT_TRUE(result.converged);
  EXPECT_NEAR(result.x[0], 1.0, 1e-3);
  EXPECT_NEAR(result.x[1], 1.0, 1e-3);
}

TEST(NelderMead, AQuadraticInFiveDimensionsAndInOne) {
  const auto bowl = [](const std::vector<double>& x) {
    double sum = 7.0;
    for (std::size_t i = 0; i < x.size(); ++i) sum += (1.0 + static_cast<double>(i)) * std::pow(x[i] - 2.0, 2);
    return sum;
  };
  for (const std::size_t dimensions : {1u, 5u}) {
    const NelderMeadResult result = nelderMead(bowl, std::vector<double>(dimensions, 0.0), 1.0, 1e-10);
    EXPECT_NEAR(result.value, 7.0, 1e-6);
    for (const double x : result.x) EXPECT_NEAR(x, 2.0, 1e-3);
  }
}

TEST(NelderMead, KeepsAwayFromWhereThereIsNoValue) {
  const auto f = [](const std::vector<double>& x) { return x[0] - std::log(x[0]); };  // NaN below 0
  EXPECT_NEAR(nelderMead(f, {0.1}, 0.5).x[0], 1.0, 1e-2);
}

TEST(NelderMead, StopsWhenToldTo) {
  const auto slope = [](const std::vector<double>& x) { return x[0]; };
  const NelderMeadResult result = nelderMead(slope, {0.0}, 1.0, 1e-7, 100);
  EXPECT_FALSE(result.converged);
  EXPECT_LT(result.evaluations, 110);
}

}  // namespace
}  // namespace fail_aware
