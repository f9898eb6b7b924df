#include "evaluation/elevation_calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/io/input_error.hpp"

namespace fail_aware::elevation_calibration_test {
namespace {

TEST(ElevationCalibration, ASingleDriveIsTakenAsItIs) {
  const ElevationEstimate mean = meanElevation({{0.2, 0.04}});
  EXPECT_DOUBLE_EQ(mean.angle_deg, 0.2);
  EXPECT_NEAR(mean.sigma_deg, 0.05, 1e-9);  // and 0.03 for the scenery
}

TEST(ElevationCalibration, AnUncertainDriveCountsLess) {
  const ElevationEstimate mean = meanElevation({{0.2, 0.04}, {0.3, 0.12}});
  EXPECT_GT(mean.angle_deg, 0.205);
  EXPECT_LT(mean.angle_deg, 0.22);
  EXPECT_LT(mean.sigma_deg, 0.05);
}

TEST(ElevationCalibration, DrivesThatDifferMakeItLessCertain) {
  const double agreed = meanElevation({{0.2, 0.04}, {0.21, 0.04}, {0.19, 0.04}}).sigma_deg;
  EXPECT_NEAR(agreed, 0.05 / std::sqrt(3.0), 1e-9);
  EXPECT_GT(meanElevation({{0.2, 0.04}, {0.4, 0.04}, {0.0, 0.04}}).sigma_deg, 3.0 * agreed);
}

TEST(ElevationCalibration, WhatADriveBeganWithIsNoEvidence) {
  // 0.3 deg measured with 0.06 deg, beside a prior of 0 with 0.15 deg
  const double posterior = 1.0 / (0.06 * 0.06) + 1.0 / (0.15 * 0.15);
  const auto own = withoutPrior({0.3 / (0.06 * 0.06) / posterior, std::sqrt(1.0 / posterior)}, 0.15);
  ASSERT_TRUE(own.has_value());
  EXPECT_NEAR(own->angle_deg, 0.3, 1e-9);
  EXPECT_NEAR(own->sigma_deg, 0.06, 1e-9);
  EXPECT_FALSE(withoutPrior({0.02, 0.14}, 0.15).has_value());
  EXPECT_FALSE(withoutPrior({0.0, 0.001}, 0.001).has_value()) << "the drive had no say";
}

TEST(ElevationCalibration, WhatIsNoNumberIsRefused) {
  EXPECT_THROW(meanElevation({}), InputError);
  EXPECT_THROW(meanElevation({{0.2, 0.0}}), InputError);
  EXPECT_THROW(meanElevation({{std::numeric_limits<double>::quiet_NaN(), 0.1}}), InputError);
}

}  // namespace
}  // namespace fail_aware::elevation_calibration_test
