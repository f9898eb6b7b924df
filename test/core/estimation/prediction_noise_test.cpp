#include "core/estimation/prediction_noise.hpp"

#include <gtest/gtest.h>

namespace fail_aware::prediction_noise_test {
namespace {

class PredictionNoiseTest : public testing::Test {
 protected:
  PredictionNoiseTest() { tracker.reset({15.0, 1.0, 1.0}, 0.3); }

  void sweep(bool measured) {
    SweepPrediction prediction;
    prediction.dt_s = last.dt_s = 0.1;
    prediction.motion_status = MotionStatus::kObserved;
    prediction.T_odom_cog_previous = last.T_odom_cog;
    x[0] += 1.0;
    last.stamp_s += 0.1;
    last.T_odom_cog = prediction.T_odom_cog = poseFromVector(x);
    last.measurement_applied = measured;
    last.fusion.z = x;
    last.fusion.R = 1e-4 * Matrix6d::Identity();
    last.fusion.R.diagonal().tail<3>().setConstant(1e-8);
    last.covariance = last.fusion.R;
    tracker.update({prediction, last, x, 0.0, measured, false});
  }

  PredictionNoise noise() const {
    return predictionNoise(VehicleModel(VehicleParameters(), VehicleModel::Params()), tracker, last, interval);
  }

  MotionTracker tracker{DeadReckoning::Params(), MotionHistory::Params(), RoadPlaneEstimator(VehicleParameters())};
  FilterState last;
  Vector6d x = Vector6d::Zero();
  const PredictionInterval interval{0.1, 0.0, 0.0, true, 15.0};
};

TEST_F(PredictionNoiseTest, AnErrorOfTheSpeedPersistsInDeadReckoning) {
  for (int k = 0; k < 10; ++k) sweep(true);
  const double observed = noise().increment(0, 0);
  EXPECT_DOUBLE_EQ(noise().filter(0, 0), observed);
  for (int k = 0; k < 5; ++k) sweep(false);
  const double of_a_sweep = noise().increment(0, 0) - observed;
  EXPECT_GT(of_a_sweep, 0.0);
  EXPECT_NEAR(noise().filter(0, 0) - observed, 5.0 * of_a_sweep, 1e-9);  // half a second
}

}  // namespace
}  // namespace fail_aware::prediction_noise_test
