#include "core/aiding/open_country_aid.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../../support/synthetic_scene.hpp"
#include "core/geometry/degree.hpp"

namespace fail_aware::open_country_aid_test {
namespace {

Measurement sureMeasurement() {
  Measurement measurement;
  measurement.status = MeasurementStatus::kOk;
  measurement.covariance = 1e-6 * Matrix6d::Identity();
  return measurement;
}

/// 10 m/s.
InitialGuess drivingGuess() {
  InitialGuess guess;
  guess.twist_cog[0] = 10.0;
  guess.dt_s = 0.1;
  return guess;
}

TEST(OpenCountryAid, InARoomThereIsNone) {
  const AboveGroundMatcher::Params params;
  OpenCountryAid aid(params, IcpPointToPlane::Params());
  LocalMap map(LocalMap::Params(), params.reference);
  RegistrationScan scan;
  scan.cloud.map_points_cog = seenFrom(sampleScene(room(), 40.0, 0.01, 1), Pose::Identity());
  scan.cloud.plane_points_cog = scan.cloud.map_points_cog;
  map.insert(scan.cloud, Pose::Identity(), 0.0, false);
  EXPECT_FALSE(aid.find(scan, map, InitialGuess(), 0.01).open_country);
}

TEST(OpenCountryAid, OnAFieldSurfacesAreTrustedLess) {
  const AboveGroundMatcher::Params params;
  Measurement measurement = sureMeasurement();
  inflateInOpenCountry(params, drivingGuess(), measurement);
  EXPECT_NEAR(std::sqrt(measurement.covariance(0, 0)), params.surface_sigma_m, 1e-3);
  EXPECT_NEAR(std::sqrt(measurement.covariance(5, 5)), params.surface_sigma_deg * kDegree, 1e-3);
  EXPECT_EQ(measurement.covariance(2, 2), 1e-6);
}

TEST(OpenCountryAid, TheMatchObservesPositionAndHeading) {
  AboveGroundPose pose{Pose::Identity(), 1e-4 * Eigen::Matrix3d::Identity()};
  pose.covariance(0, 2) = pose.covariance(2, 0) = 2e-5;
  pose.T_odom_cog.translation().x() = 0.5;
  const Measurement measurement = aboveGroundMeasurement(pose);
  ASSERT_TRUE(measurement.ok());
  EXPECT_EQ(measurement.T_odom_cog.translation().x(), 0.5);
  EXPECT_EQ(measurement.covariance(1, 1), 1e-4);
  EXPECT_EQ(measurement.covariance(0, 5), 2e-5);
  for (const int i : {2, 3, 4}) EXPECT_EQ(measurement.covariance(i, i), kUnobservedVariance);
}

}  // namespace
}  // namespace fail_aware::open_country_aid_test
