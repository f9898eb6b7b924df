#include "core/preprocessing/azimuth_correction.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/geometry/degree.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::azimuth_correction_test {
namespace {

TEST(AzimuthCorrection, TurnsCounterClockwiseSeenFromAbove) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 150; ++i) {  // not a multiple of the block size
    const double azimuth = 0.11 * i - 3.1, way = 2.0 + 0.7 * i;
    points.emplace_back(static_cast<float>(way * std::cos(azimuth)), static_cast<float>(way * std::sin(azimuth)),
                        0.1f * static_cast<float>(i % 30) - 2.0f);
  }
  std::vector<Eigen::Vector3f> corrected = points;
  correctAzimuth({-0.4}, corrected);
  const Eigen::AngleAxisd turn(-0.4 * kDegree, Eigen::Vector3d::UnitZ());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = points[i].cast<double>();
    EXPECT_LT((turn * p - corrected[i].cast<double>()).norm(), 1e-6 * p.norm());
    EXPECT_EQ(corrected[i].z(), points[i].z());
  }
  std::vector<Eigen::Vector3f> ahead = {{10.0f, 0.0f, 0.0f}};
  correctAzimuth({1.0}, ahead);
  EXPECT_GT(ahead[0].y(), 0.17f);
}

TEST(AzimuthCorrection, ZeroIsOff) {
  const std::vector<Eigen::Vector3f> points = {{10.0f, -4.0f, 1.0f}, {0.0f, 0.0f, 0.0f}};
  std::vector<Eigen::Vector3f> same = points;
  correctAzimuth({}, same);
  EXPECT_EQ(same, points);
}

TEST(AzimuthCorrection, RefusesAbsurdAngles) {
  for (const double angle_deg : {-10.1, 10.1, std::nan("")}) {
    EXPECT_THROW(validate(AzimuthCorrectionParams{angle_deg}), ParameterError) << angle_deg;
  }
  EXPECT_NO_THROW(validate(AzimuthCorrectionParams{-10.0}));
}

}  // namespace
}  // namespace fail_aware::azimuth_correction_test
