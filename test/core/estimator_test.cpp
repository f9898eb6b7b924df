#include "core/estimator.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fail_aware::estimator_test {
namespace {

/// A car that is measured well at each sweep, straight on at 10 m/s.
class EstimatorTest : public testing::Test {
 protected:
  static constexpr double kSpeed_mps = 10.0;

  Measurement measured(double time_s) const {
    Measurement measurement;
    measurement.status = MeasurementStatus::kOk;
    measurement.T_odom_cog =
        T_odom_start * poseFromVector((Vector6d() << kSpeed_mps * time_s, 0, 0, 0, 0, 0).finished());
    measurement.covariance = 1e-4 * Matrix6d::Identity();
    measurement.iterations = 5;
    return measurement;
  }
  const FilterState& sweep(double time_s, double stamp_s) {
    const Estimator::Accepted accepted = estimator.accept(stamp_s);
    if (accepted.beginsDrive()) T_odom_start = Pose(estimator.state().T_odom_cog), begin_s = time_s;
    SweepPrediction prediction;
    if (!accepted.taken() || !estimator.predict(stamp_s, accepted.set_back_s, prediction)) return estimator.state();
    const Measurement point = measured(time_s - begin_s), plane = point;
    return estimator.update({{kIcpPointToPoint, &point}, {kIcpPointToPlane, &plane}}, SweepFindings());
  }
  void drive(double from_s, double to_s, double clock_s = kClock_s) {
    for (double t = from_s; t < to_s - 0.05; t += 0.1) sweep(t, clock_s + t);
  }

  static constexpr double kClock_s = 1000.0;
  PipelineParameters params;
  Estimator estimator{params};
  Pose T_odom_start = Pose(estimator.state().T_odom_cog);
  double begin_s = 0.0;
};

TEST_F(EstimatorTest, FollowsWhatIsMeasured) {
  drive(0.0, 3.0);
  EXPECT_NEAR((T_odom_start.inverse() * estimator.state().T_odom_cog).translation().x(), 29.0, 0.2);
  EXPECT_TRUE(estimator.covarianceIsWhole());
  EXPECT_GT(estimator.odometryCovariance()(0, 0), 0.0);
  EXPECT_NEAR(*estimator.sweepClock().period_s(), 0.1, 1e-5);
}

TEST_F(EstimatorTest, RefusesStampsThatDoNotAdvance) {
  drive(0.0, 1.0);
  EXPECT_EQ(estimator.accept(kClock_s + 0.9).order, StampOrder::kSame);
  EXPECT_EQ(estimator.accept(kClock_s + 0.8).order, StampOrder::kReordered);
  EXPECT_FALSE(estimator.accept(std::nan("")).taken());
  EXPECT_FALSE(estimator.accept(kClock_s + 1e5).taken()) << "one stamp far ahead";
  EXPECT_TRUE(estimator.accept(kClock_s + 1.0).taken());
}

TEST_F(EstimatorTest, JumpOfTheStampsGoesOnFromTheLastPose) {
  drive(0.0, 3.0);
  const Pose last = estimator.state().T_odom_cog;
  const double grown = estimator.odometryCovariance()(0, 0);
  sweep(3.0, kClock_s - 50.0);
  EXPECT_GT(estimator.state().dt_s, 0.0) << "refused: it may be wrong";
  sweep(3.1, kClock_s - 49.9);
  EXPECT_EQ(estimator.state().dt_s, 0.0) << "the first sweep of a drive";
  EXPECT_LT((estimator.state().T_odom_cog.translation() - last.translation()).norm(), 0.02);
  EXPECT_LT(estimator.odometryCovariance()(0, 0), grown);
}

TEST_F(EstimatorTest, ResetGoesBackToTheOrigin) {
  drive(0.0, 3.0);
  estimator.reset();
  EXPECT_TRUE(estimator.state().T_odom_cog.isApprox(params.vehicle.T_base_cog()));
  EXPECT_TRUE(estimator.accept(kClock_s - 100.0).taken()) << "any stamp is the first";
}

TEST_F(EstimatorTest, PoseIsSetWithTheNextSweep) {
  drive(0.0, 3.0);
  const Pose far = poseFromVector((Vector6d() << 500.0, 70.0, 0.0, 0.0, 0.0, 1.0).finished());
  EXPECT_NE(estimator.setPose({kClock_s + 20.0, far, 0.01 * Matrix6d::Identity()}), "") << "too far in time";
  EXPECT_EQ(estimator.setPose({kClock_s + 2.9, far, 0.01 * Matrix6d::Identity()}), "");
  sweep(3.0, kClock_s + 3.0);
  EXPECT_TRUE(estimator.takePoseSet().done);
  const Pose T_odom_base = estimator.state().T_odom_cog * params.vehicle.T_base_cog().inverse();
  EXPECT_NEAR((T_odom_base.translation() - far.translation()).norm(), 1.0, 0.1) << "a sweep further on";
  EXPECT_NEAR(estimator.odometryCovariance()(5, 5), 0.01, 1e-3);
  EXPECT_EQ(estimator.setPose({kClock_s + 3.0, far, 0.01 * Matrix6d::Identity()}), "");
  sweep(3.0, kClock_s - 50.0);
  sweep(3.1, kClock_s - 49.9);
  EXPECT_NE(estimator.takePoseSet().refused, "") << "a new drive";
  EXPECT_EQ(estimator.takePoseSet().refused, "") << "told once";
}

TEST_F(EstimatorTest, PoseOfAnotherInstantWaitsForAMotion) {
  Pose far = Pose::Identity();
  far.translation().x() = 500.0;
  EXPECT_EQ(estimator.setPose({kClock_s - 0.5, far, 0.01 * Matrix6d::Identity()}), "");
  sweep(0.0, kClock_s);
  EXPECT_FALSE(estimator.takePoseSet().done) << "how far the vehicle drove since then is not known";
  bool done = false;
  for (double t = 0.1; t < 0.45; t += 0.1) {
    sweep(t, kClock_s + t);
    if (!estimator.takePoseSet().done) continue;
    done = true;
    const Pose T_odom_base = estimator.state().T_odom_cog * params.vehicle.T_base_cog().inverse();
    EXPECT_NEAR(T_odom_base.translation().x(), 500.0 + kSpeed_mps * (t + 0.5), 0.5);
    break;
  }
  EXPECT_TRUE(done);
}

TEST_F(EstimatorTest, PoseWithoutAStampIsThatOfTheNextSweep) {
  Pose far = Pose::Identity();
  far.translation().x() = 500.0;
  sweep(0.0, kClock_s);
  EXPECT_EQ(estimator.setPose({0.0, far, 0.01 * Matrix6d::Identity()}), "");
  bool done = false;
  for (double t = 0.1; t < 0.45 && !done; t += 0.1) {
    sweep(t, kClock_s + t);
    done = estimator.takePoseSet().done;
    const Pose T_odom_base = estimator.state().T_odom_cog * params.vehicle.T_base_cog().inverse();
    if (done) {
      EXPECT_NEAR(T_odom_base.translation().x(), 500.0 + kSpeed_mps * (t - 0.1), 0.2);
    }
  }
  EXPECT_TRUE(done);
}

TEST_F(EstimatorTest, ExternalPosesJoinTheFusion) {
  estimator.addSource("gps", 0.06);
  EXPECT_NE(estimator.offer("other", ExternalPose()), "");
  EXPECT_NE(estimator.offer("gps", ExternalPose()), "") << "a covariance of zeros";
  drive(0.0, 3.0);
  const Pose T_odom_base = estimator.state().T_odom_cog * params.vehicle.T_base_cog().inverse();
  EXPECT_EQ(estimator.offer("gps", {kClock_s + 2.95, T_odom_base, 0.01 * Matrix6d::Identity()}), "");
  sweep(3.0, kClock_s + 3.0);
  ASSERT_EQ(estimator.externalMeasurements().size(), 1u);
  EXPECT_TRUE(estimator.externalMeasurements()[0].measurement);
  EXPECT_EQ(estimator.state().fusion.weights.size(), 3u);
  sweep(3.1, kClock_s + 3.1);
  EXPECT_FALSE(estimator.externalMeasurements()[0].measurement) << "each is used once";
}

}  // namespace
}  // namespace fail_aware::estimator_test
