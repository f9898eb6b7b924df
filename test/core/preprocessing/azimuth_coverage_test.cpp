#include "core/preprocessing/azimuth_coverage.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace fail_aware::azimuth_coverage_test {
namespace {

/// One point a degree, from 0 to `to_deg`.
std::vector<Eigen::Vector3f> arc(int to_deg) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < to_deg; ++i) {
    const double azimuth_rad = (i + 0.5) * M_PI / 180.0;
    points.emplace_back(10.0 * std::cos(azimuth_rad), 10.0 * std::sin(azimuth_rad), -1.0);
  }
  return points;
}

TEST(AzimuthCoverage, IsTheRatioOfTheRevolution) {
  EXPECT_EQ(azimuthCoverage(arc(360)), 1.0);
  EXPECT_EQ(azimuthCoverage(arc(180)), 0.5);
  EXPECT_EQ(azimuthCoverage({}), 0.0);
}

TEST(AzimuthCoverage, ASectorNeedsThreePoints) {
  EXPECT_EQ(azimuthCoverage(arc(2)), 0.0);
  EXPECT_EQ(azimuthCoverage(arc(360), 2), 0.5) << "three and two points by turns";
}

TEST(AzimuthCoverage, PointsThatAreNoNumbersDoNoHarm) {
  std::vector<Eigen::Vector3f> points(3, Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  EXPECT_LE(azimuthCoverage(points), 1.0 / 72.0);
}

}  // namespace
}  // namespace fail_aware::azimuth_coverage_test
