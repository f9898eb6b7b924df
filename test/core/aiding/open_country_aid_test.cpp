#include "core/aiding/open_country_aid.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../../support/synthetic_scene.hpp"
#include "core/geometry/degree.hpp"

namespace fail_aware {
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
  LocalMap map(ReferenceMap::Params(), params.reference());
  RegistrationScan scan;
  scan.cloud.map_points_cog = seenFrom(sampleScene(room(), 40.0, 0.01, 1), Pose::Identity());
  scan.cloud.plane_points_cog = scan.cloud.map_points_cog;
  map.insert(scan.cloud, Pose::Identity(), 0.0, false);
  EXPECT_FALSE(aid.find(scan, map, InitialGuess(), 0.01).open_country);
}

TEST(OpenCountryAid, OnAFieldSurfacesAreTrustedLess) {
  const AboveGroundMatcher::Params params;
  OpenCountryAid::Result found;
  Measurement measurement = sureMeasurement();
  addOpenCountry(found, params, drivingGuess(), measurement);
  EXPECT_EQ(measurement.covariance(0, 0), 1e-6);
  found.open_country = true;
  addOpenCountry(found, params, drivingGuess(), measurement);
  EXPECT_NEAR(std::sqrt(measurement.covariance(0, 0)), params.surface_sigma_m, 1e-3);
  EXPECT_NEAR(std::sqrt(measurement.covariance(5, 5)), params.surface_sigma_deg * kDegree, 1e-3);
  EXPECT_EQ(measurement.covariance(2, 2), 1e-6);
}

TEST(OpenCountryAid, TheMatchTakesOver) {
  OpenCountryAid::Result found;
  found.open_country = true;
  StandingPose pose{Pose::Identity(), 1e-4 * Eigen::Matrix3d::Identity()};
  pose.T_odom_cog.translation().x() = 0.5;
  found.pose = pose;
  Measurement measurement = sureMeasurement();
  addOpenCountry(found, AboveGroundMatcher::Params(), drivingGuess(), measurement);
  EXPECT_NEAR(measurement.T_odom_cog.translation().x(), 0.5, 0.01);
  EXPECT_LT(measurement.covariance(0, 0), 2e-4);
}

}  // namespace
}  // namespace fail_aware
