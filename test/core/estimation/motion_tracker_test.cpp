#include "core/estimation/motion_tracker.hpp"

#include <gtest/gtest.h>

namespace fail_aware::motion_tracker_test {
namespace {

/// Sweeps of a car that drives straight on.
class MotionTrackerTest : public testing::Test {
 protected:
  MotionTrackerTest()
      : tracker(DeadReckoning::Params(), MotionHistory::Params(), RoadPlaneEstimator(VehicleParameters())) {
    tracker.reset({15.0, 1.0, 1.0}, 0.3);
  }

  void sweep(double speed_mps, bool measured = true, double sigma_m = 0.01, double estimate_sigma_m = 0.01) {
    const Pose previous = state.T_odom_cog;
    x[0] += 0.1 * speed_mps;
    state.stamp_s += 0.1;
    state.dt_s = 0.1;
    state.T_odom_cog = poseFromVector(x);
    state.T_previous_now = previous.inverse() * state.T_odom_cog;
    state.measurement_applied = measured;
    state.fusion.z = x;
    state.fusion.R = sigma_m * sigma_m * Matrix6d::Identity();
    state.fusion.R.diagonal().tail<3>().setConstant(1e-8);
    state.covariance = estimate_sigma_m * estimate_sigma_m * Matrix6d::Identity();
    SweepPrediction prediction;
    prediction.dt_s = 0.1;
    prediction.motion_status = MotionStatus::kObserved;
    prediction.T_odom_cog_previous = previous;
    prediction.T_odom_cog = state.T_odom_cog;
    tracker.update({prediction, state, x, 0.0, measured, false});
  }
  void sweeps(int count, double speed_mps) {
    for (int i = 0; i < count; ++i) sweep(speed_mps);
  }

  MotionTracker tracker;
  FilterState state;
  Vector6d x = Vector6d::Zero();
};

TEST_F(MotionTrackerTest, MeasuredSweepsGiveTheSpeed) {
  sweeps(10, 12.0);
  EXPECT_NEAR(tracker.motion().velocity_body_mps.x(), 12.0, 0.05);
  EXPECT_FALSE(tracker.deadReckoning().active());
  EXPECT_TRUE(tracker.lastMeasured() && tracker.previousMeasured());
}

TEST_F(MotionTrackerTest, SpeedCoastsWithoutMeasurement) {
  sweeps(10, 12.0);
  for (int i = 0; i < 5; ++i) sweep(30.0, false);
  EXPECT_NEAR(tracker.motion().velocity_body_mps.x(), 12.0, 0.5) << "predictions tell nothing";
  EXPECT_TRUE(tracker.deadReckoning().active());
  EXPECT_FALSE(tracker.lastMeasured());
  sweeps(10, 12.0);
  EXPECT_FALSE(tracker.deadReckoning().active());
}

TEST_F(MotionTrackerTest, AStepFromAnUncertainEstimateTellsLittleOfTheSpeed) {
  const auto speedAfterAStep = [&](double estimate_sigma_m) {
    tracker.reset({15.0, 1.0, 1.0}, 0.3);
    sweeps(10, 12.0);
    for (int i = 0; i < 5; ++i) sweep(12.0, true, 0.06, estimate_sigma_m);
    sweep(13.0);
    return tracker.motion().velocity_body_mps.x();
  };
  EXPECT_LT(speedAfterAStep(0.1), 12.4);
  EXPECT_GT(speedAfterAStep(0.01), 12.6);
}

// Both ICPs fail in a tunnel, and the road tells that the vehicle brakes.
TEST_F(MotionTrackerTest, AMotionAloneCorrectsTheSpeed) {
  sweeps(10, 12.0);
  for (int i = 0; i < 20; ++i) {
    MotionMeasurement motion;
    motion.z = x;
    motion.z[0] += 0.1 * 10.0;
    motion.R = kUnobservedVariance * Matrix6d::Identity();
    motion.R(0, 0) = 0.05 * 0.05;
    state.fusion.motion = motion;
    sweep(10.0, false);
  }
  EXPECT_NEAR(tracker.motion().velocity_body_mps.x(), 10.0, 0.3);
  EXPECT_TRUE(tracker.deadReckoning().active());
}

TEST_F(MotionTrackerTest, SpeedIsLimited) {
  sweeps(10, 200.0);
  EXPECT_NEAR(tracker.motion().velocity_body_mps.norm(), 80.0, 1e-9);
}

TEST_F(MotionTrackerTest, TellingNoMotionLastsASweepLonger) {
  sweeps(10, 12.0);
  tracker.setVelocityUnobservable(true, true);
  EXPECT_TRUE(tracker.velocityUnobservable());
  tracker.setVelocityUnobservable(false, false);
  EXPECT_TRUE(tracker.velocityUnobservable()) << "no measurement, no answer";
  tracker.setVelocityUnobservable(false, true);
  EXPECT_TRUE(tracker.velocityObservableAgain());
  tracker.reset({15.0, 1.0, 1.0}, 0.3);
  EXPECT_FALSE(tracker.velocityObservableAgain());
  EXPECT_EQ(tracker.motion().velocity_body_mps.norm(), 0.0);
}

}  // namespace
}  // namespace fail_aware::motion_tracker_test
