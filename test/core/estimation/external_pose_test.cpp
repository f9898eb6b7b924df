#include "core/estimation/external_pose.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../../support/poses.hpp"
#include "core/estimation/measurement_fusion.hpp"

namespace fail_aware::external_pose_test {
namespace {

ExternalPose gps(double stamp_s, const Pose& T_odom_base, double sigma_m = 0.5, double sigma_rad = 0.01) {
  ExternalPose external;
  external.stamp_s = stamp_s;
  external.T_odom_base = T_odom_base;
  external.covariance.diagonal().head<3>().setConstant(sigma_m * sigma_m);
  external.covariance.diagonal().tail<3>().setConstant(sigma_rad * sigma_rad);
  return external;
}

const Pose kBaseCog = pose(0.3, 0.0, 0.5, 0.0, 0.0, 0.0);

TEST(ExternalPose, SaysWhyItCannotBeUsed) {
  EXPECT_EQ(unusableReason(gps(1.0, Pose::Identity())), "");
  EXPECT_EQ(unusableReason(gps(1.0, Pose::Identity(), 0.5, 0.0)), "") << "position alone";
  ExternalPose bad = gps(std::numeric_limits<double>::quiet_NaN(), Pose::Identity());
  EXPECT_NE(unusableReason(bad), "");
  bad = gps(1.0, Pose::Identity());
  bad.T_odom_base.translation().y() = std::numeric_limits<double>::infinity();
  EXPECT_NE(unusableReason(bad), "");
  bad = gps(1.0, Pose::Identity());
  bad.covariance(2, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(unusableReason(bad), "");
  bad = gps(1.0, Pose::Identity(), 0.0, 0.0);
  EXPECT_NE(unusableReason(bad).find("all zero"), std::string::npos);
  bad = gps(1.0, Pose::Identity());
  bad.covariance(0, 1) = 0.1;
  EXPECT_NE(unusableReason(bad).find("symmetric"), std::string::npos);
  bad = gps(1.0, Pose::Identity());
  bad.covariance(1, 1) = -1.0;
  EXPECT_NE(unusableReason(bad).find("not positive"), std::string::npos);
}

TEST(ExternalPose, HugeValuesAreRefused) {
  EXPECT_NE(unusableReason(gps(1.0, Pose(Eigen::Translation3d(0.0, -1.1e9, 0.0)))).find("beyond"), std::string::npos);
  ExternalPose huge = gps(1.0, Pose::Identity());
  huge.covariance(4, 4) = 1.1e12;
  EXPECT_NE(unusableReason(huge).find("above"), std::string::npos);
  huge = gps(1.0, Pose(Eigen::Translation3d(1e9, 1e9, 1e9)), 1e6, 1e6);
  ASSERT_EQ(unusableReason(huge), "");
  const Measurement m = externalMeasurement(huge, 1.05, Pose::Identity(), Vector6d::Constant(1.0), kBaseCog);
  EXPECT_TRUE(m.covariance.allFinite());
  EXPECT_TRUE(isFinite(m.T_odom_cog));
}

TEST(ExternalPose, AtTheSweepsStampOnlyTheCentreOfGravityIsFound) {
  const Pose T_odom_base = pose(10.0, -4.0, 1.0, 0.02, -0.03, 2.0);
  const Measurement m = externalMeasurement(gps(5.0, T_odom_base), 5.0, Pose::Identity(),
                                            (Vector6d() << 10, 0, 0, 0, 0, 0.3).finished(), kBaseCog);
  EXPECT_TRUE(m.ok());
  EXPECT_TRUE(m.T_odom_cog.isApprox(T_odom_base * kBaseCog, 1e-12));
  EXPECT_TRUE(m.covariance.isApprox(covarianceAfterOffset(gps(5.0, T_odom_base).covariance, T_odom_base, kBaseCog)));
}

TEST(ExternalPose, IsMovedAlongTheVehiclesCurveBothWaysInTime) {
  const Vector6d twist_cog = (Vector6d() << 20.0, 0.1, 0.0, 0.0, 0.0, 0.5).finished();
  const Pose T_odom_cog_at_7 = pose(3.0, 2.0, 0.5, 0.0, 0.01, -1.0);
  const auto baseAt = [&](double stamp_s) -> Pose {
    return T_odom_cog_at_7 * expSe3((stamp_s - 7.0) * twist_cog) * kBaseCog.inverse();
  };
  for (const double stamp_s : {6.92, 7.0, 7.07}) {
    const Measurement m =
        externalMeasurement(gps(stamp_s, baseAt(stamp_s)), 7.0, Pose::Identity(), twist_cog, kBaseCog);
    EXPECT_TRUE(m.T_odom_cog.isApprox(T_odom_cog_at_7, 1e-9)) << stamp_s;
    const double motion_m = std::abs(stamp_s - 7.0) * twist_cog.head<3>().norm();
    EXPECT_GE(m.covariance(0, 0), 0.25 + 0.01 * motion_m * motion_m - 1e-12) << "what the motion adds";
  }
}

TEST(ExternalPose, ARotationThatWasNotMeasuredIsThePredictedOne) {
  const Vector6d twist_cog = (Vector6d() << 20.0, 0.0, 0.0, 0.0, 0.0, 0.4).finished();
  const Pose T_odom_cog = pose(3.0, 2.0, 0.5, 0.0, 0.0, 2.5);
  const Pose T_odom_base_then = T_odom_cog * expSe3(-0.05 * twist_cog) * kBaseCog.inverse();
  ExternalPose position_only = gps(6.95, Pose::Identity(), 0.5, 0.0);
  position_only.T_odom_base.translation() = T_odom_base_then.translation();
  const Measurement m = externalMeasurement(position_only, 7.0, T_odom_cog, twist_cog, kBaseCog);
  EXPECT_TRUE(m.T_odom_cog.isApprox(T_odom_cog, 1e-9));
  EXPECT_GT(m.covariance(5, 5), 1e3);
  EXPECT_LT(m.covariance(0, 0), 0.3);
  // and the fusion takes the position alone
  Matrix6d P = Matrix6d::Identity() * 1e-4;
  Vector6d predicted = vectorFromPose(T_odom_cog);
  predicted[0] += 0.3;
  predicted[5] += 0.01;
  const FusionResult fused = MeasurementFusion().fuse(predicted, P, {{"gps", &m, FusionInput::Kind::kExternal}});
  EXPECT_EQ(fused.valid_inputs, 1);
  EXPECT_GT(fused.weights[0], 0.5);
  EXPECT_NEAR(fused.z[0], 3.0, 1e-6);
  EXPECT_GT(fused.R(5, 5), 1e3);
}

TEST(ExternalPose, DisagreesOnlyBeyondBothCovariances) {
  const Measurement near = externalMeasurement(gps(1.0, pose(0.9, 0, 0, 0, 0, 0)), 1.0, Pose::Identity(),
                                               Vector6d::Zero(), Pose::Identity());
  const Measurement far = externalMeasurement(gps(1.0, pose(5.0, 0, 0, 0, 0, 0)), 1.0, Pose::Identity(),
                                              Vector6d::Zero(), Pose::Identity());
  Measurement icp = externalMeasurement(gps(1.0, Pose::Identity(), 0.02, 0.001), 1.0, Pose::Identity(),
                                        Vector6d::Zero(), Pose::Identity());
  const MeasurementFusion fusion;
  const Matrix6d P = 1e-4 * Matrix6d::Identity();
  EXPECT_EQ(
      fusion.fuse(Vector6d::Zero(), P, {{"icp", &icp}, {"gps", &near, FusionInput::Kind::kExternal}}).disagreement_m,
      0.0);
  EXPECT_NEAR(
      fusion.fuse(Vector6d::Zero(), P, {{"icp", &icp}, {"gps", &far, FusionInput::Kind::kExternal}}).disagreement_m,
      5.0, 1e-9);
  EXPECT_NEAR(fusion.fuse(Vector6d::Zero(), P, {{"icp", &icp}, {"second", &near}}).disagreement_m, 0.9, 1e-9);
}

TEST(ExternalPose, ARefusalIsToldInMetresAndSigmas) {
  const auto refusal = [](double x_m, double sigma_m, const Matrix6d& P = 1e-4 * Matrix6d::Identity()) {
    const Measurement m = externalMeasurement(gps(1.0, pose(x_m, 0, 0, 0, 0, 0), sigma_m), 1.0, Pose::Identity(),
                                              Vector6d::Zero(), Pose::Identity());
    const FusionResult fused =
        MeasurementFusion().fuse(Vector6d::Zero(), P, {{"gps", &m, FusionInput::Kind::kExternal}});
    return refusalOf(fused, 0, stateDifference(vectorFromPose(m.T_odom_cog), Vector6d::Zero()));
  };
  EXPECT_EQ(refusal(1.0, 0.5), "") << "within 3 sigma";
  EXPECT_NE(refusal(5.0, 0.5).find("5.0 m, in height 0.0 m, in yaw 0.0 deg from the prediction (10.0 sigma), beyond"),
            std::string::npos)
      << refusal(5.0, 0.5);
  EXPECT_NE(refusal(2e5, 0.5).find("cannot be used"), std::string::npos) << "farther than any car drives in an hour";
  EXPECT_EQ(refusal(5.0, 0.5, Matrix6d::Constant(std::nan(""))), "") << "the prediction is what cannot be used";
}

TEST(ExternalPoseSource, AnotherClockIsNamed) {
  SweepPrediction prediction;
  prediction.stamp_s = 100.0;
  prediction.dt_s = 0.1;
  prediction.motion_status = MotionStatus::kObserved;
  const auto fault = [&](double pose_stamp_s) {
    ExternalPoseSource source;
    EXPECT_EQ(source.offer(gps(pose_stamp_s, Pose::Identity())), "");
    source.measure(prediction, Pose::Identity());
    const std::string told = source.timeFault();
    source.measure(prediction, Pose::Identity());
    EXPECT_EQ(source.timeFault(), "") << "no pose came since";
    return told;
  };
  ExternalPoseSource cleared;
  cleared.offer(gps(82.0, Pose::Identity()));
  cleared.measure(prediction, Pose::Identity());
  ASSERT_NE(cleared.timeFault(), "");
  cleared.clear();
  EXPECT_EQ(cleared.timeFault(), "");
  EXPECT_EQ(fault(82.0), "its stamp is 18.0 s before the sweep's (tolerance 0.10 s): check its clock");
  EXPECT_EQ(fault(105.0), "its stamp is 5.0 s after the sweep's (tolerance 0.10 s): check its clock");
  EXPECT_EQ(fault(99.5), "") << "late";
  EXPECT_EQ(fault(100.05), "");
}

TEST(ExternalPose, AHeightOrYawFarFromThePredictionIsRefused) {
  const auto weight = [](double z_m, double yaw_rad, FusionInput::Kind kind) {
    const Measurement m = externalMeasurement(gps(1.0, pose(0, 0, z_m, 0, 0, yaw_rad), 0.05, 0.002), 1.0,
                                              Pose::Identity(), Vector6d::Zero(), Pose::Identity());
    return MeasurementFusion().fuse(Vector6d::Zero(), 1e-6 * Matrix6d::Identity(), {{"gps", &m, kind}}).weights[0];
  };
  EXPECT_GT(weight(0.0, 0.0, FusionInput::Kind::kExternal), 0.9);
  EXPECT_GT(weight(1.0, 0.004, FusionInput::Kind::kExternal), 0.0) << "datums differ";
  EXPECT_EQ(weight(47.0, 0.0, FusionInput::Kind::kExternal), 0.0) << "a height above another datum";
  EXPECT_EQ(weight(0.0, -0.05, FusionInput::Kind::kExternal), 0.0) << "a compass that is turned";
  EXPECT_GT(weight(0.0, -0.05, FusionInput::Kind::kPose), 0.0);
}

TEST(ExternalPose, HasNoVoteAgainstWhatItsCovarianceBearsOut) {
  const auto at = [](double x_m, double sigma_m) {
    return externalMeasurement(gps(1.0, pose(x_m, 0, 0, 0, 0, 0), sigma_m, 0.001), 1.0, Pose::Identity(),
                               Vector6d::Zero(), Pose::Identity());
  };
  const Measurement icp = at(0.0, 0.02), second = at(1.0, 0.02), rough = at(0.0, 0.5), fine = at(0.0, 0.02);
  const MeasurementFusion fusion;
  const Matrix6d P = 1e-4 * Matrix6d::Identity();
  const FusionResult undecided = fusion.fuse(
      Vector6d::Zero(), P, {{"icp", &icp}, {"second", &second}, {"gps", &rough, FusionInput::Kind::kExternal}});
  EXPECT_NEAR(undecided.undecided_m, 1.0, 1e-9);
  EXPECT_FALSE(undecided.confirmed);
  const FusionResult outvoted = fusion.fuse(
      Vector6d::Zero(), P, {{"icp", &icp}, {"second", &second}, {"gps", &fine, FusionInput::Kind::kExternal}});
  EXPECT_NEAR(outvoted.undecided_m, 0.0, 1e-9);
  EXPECT_TRUE(outvoted.confirmed);
}

TEST(ExternalPose, ConfirmsOnlyIfItKnowsWhereItIs) {
  const auto at = [](double x_m, double sigma_m) {
    return externalMeasurement(gps(1.0, pose(x_m, 0, 0, 0, 0, 0), sigma_m, 0.001), 1.0, Pose::Identity(),
                               Vector6d::Zero(), Pose::Identity());
  };
  const Measurement icp = at(0.0, 0.02), rough = at(0.1, 1.0), fine = at(0.1, 0.05);
  const MeasurementFusion fusion;
  const Matrix6d P = 1e-2 * Matrix6d::Identity();
  EXPECT_FALSE(
      fusion.fuse(Vector6d::Zero(), P, {{"icp", &icp}, {"gps", &rough, FusionInput::Kind::kExternal}}).confirmed);
  EXPECT_TRUE(
      fusion.fuse(Vector6d::Zero(), P, {{"icp", &icp}, {"gps", &fine, FusionInput::Kind::kExternal}}).confirmed);
}

/// Offers a pose whose x is its stamp.
void offer(ExternalPoseSource& source, double stamp_s) {
  EXPECT_EQ(source.offer(gps(stamp_s, pose(stamp_s, 0, 0, 0, 0, 0))), "");
}

/// The stamp of the pose that a standing vehicle's sweep takes; -1: none.
double takenAt(ExternalPoseSource& source, double stamp_s) {
  SweepPrediction prediction;
  prediction.stamp_s = stamp_s;
  prediction.dt_s = 0.1;
  prediction.motion_status = MotionStatus::kObserved;
  const std::optional<Measurement> m = source.measure(prediction, Pose::Identity());
  return m ? m->T_odom_cog.translation().x() : -1.0;
}

TEST(ExternalPoseSource, GivesTheNearestWithinTolerance) {
  ExternalPoseSource source(0.1);
  EXPECT_EQ(takenAt(source, 1.0), -1.0);
  for (const double stamp_s : {1.0, 1.1, 1.2, 1.3}) offer(source, stamp_s);
  EXPECT_EQ(takenAt(source, 1.45), -1.0);
  EXPECT_EQ(takenAt(source, 1.14), 1.1);
  EXPECT_EQ(takenAt(source, 1.14), 1.2) << "the nearest one was used up, and what is older with it";
  EXPECT_EQ(takenAt(source, 1.14), -1.0);
  EXPECT_EQ(takenAt(source, 1.3), 1.3);
}

TEST(ExternalPoseSource, IsBoundedAndBeginsAnewWhenStampsGoBack) {
  ExternalPoseSource source(0.5);
  const int count = static_cast<int>(ExternalPoseSource::kKept) + 2;
  for (int i = 0; i < count; ++i) offer(source, i);
  EXPECT_EQ(takenAt(source, 1.0), -1.0) << "the oldest gave way";
  EXPECT_EQ(takenAt(source, 2.0), 2.0);
  offer(source, 0.5);
  EXPECT_EQ(takenAt(source, count - 1.0), -1.0);
  EXPECT_EQ(takenAt(source, 0.4), 0.5);
}

}  // namespace
}  // namespace fail_aware::external_pose_test
