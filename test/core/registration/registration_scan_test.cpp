#include "core/registration/registration_scan.hpp"

#include <gtest/gtest.h>

#include "../../support/synthetic_drive.hpp"

namespace fail_aware::registration_scan_test {
namespace {

SweepPrediction predictedAhead(double distance_m, double dt_s) {
  SweepPrediction prediction;
  prediction.dt_s = dt_s;
  prediction.T_odom_cog.translation().x() = distance_m;
  return prediction;
}

RegistrationScanBuilder makeBuilder() { return {RegistrationCloudBuilder({}), BeamBiasEstimator({}, {})}; }

TEST(RegistrationScan, KnowsTheMotionThatItIsDeskewedFor) {
  const SyntheticDrive drive;
  RegistrationScanBuilder builder = makeBuilder();
  RegistrationScan scan;
  builder.build(drive.sweep(0.0, 1), predictedAhead(0.0, 0.0), drive.T_cog_lidar, scan);
  EXPECT_TRUE(scan.usable);
  EXPECT_EQ(scan.twist_cog, Vector6d(Vector6d::Zero()));
  builder.build(drive.sweep(0.0, 1), predictedAhead(1.2, 0.1), drive.T_cog_lidar, scan);
  EXPECT_NEAR(scan.twist_cog[0], 12.0, 1e-9);
}

TEST(RegistrationScan, TooFewPointsAreNotUsable) {
  const SyntheticDrive drive;
  RegistrationScanBuilder builder = makeBuilder();
  RegistrationScan scan;
  CorrectedSweep sweep = drive.sweep(0.0, 1);
  sweep.points_lidar.resize(300);
  sweep.times_s.resize(300);
  builder.build(sweep, SweepPrediction(), drive.T_cog_lidar, scan);
  EXPECT_FALSE(scan.usable);
}

TEST(RegistrationScan, RedeskewsByWhatIsMissing) {
  RegistrationScan scan;
  scan.cloud.map_points_cog = {{10.0f, 0.0f, 0.0f}};
  scan.cloud.map_times_s = {0.04f};
  scan.twist_cog[0] = 10.0;
  Vector6d faster = Vector6d::Zero();
  faster[0] = 15.0;
  scan.redeskewTo(faster, -0.01);
  EXPECT_NEAR(scan.cloud.map_points_cog[0].x(), 10.25, 1e-5);
  EXPECT_EQ(scan.twist_cog, faster);
}

}  // namespace
}  // namespace fail_aware::registration_scan_test
