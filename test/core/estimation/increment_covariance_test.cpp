#include "core/estimation/increment_covariance.hpp"

#include <gtest/gtest.h>

#include "core/geometry/degree.hpp"

namespace fail_aware {
namespace {

FilterState measured(double sigma_m) {
  FilterState state;
  state.dt_s = 0.1;
  state.measurement_applied = true;
  state.fusion.R = sigma_m * sigma_m * Matrix6d::Identity();
  return state;
}

TEST(IncrementCovariance, GoodMeasurementLeavesLittleOpen) {
  const Matrix6d Q = 0.01 * Matrix6d::Identity();
  FilterState state = measured(0.01);
  setIncrementCovariance(IncrementFloor(), Q, 1.0, SweepPrediction(), state);
  EXPECT_NEAR(state.increment_covariance(0, 0), 1e-4, 2e-6);
  EXPECT_LT(state.unobserved_covariance(0, 0), 2e-6);
}

TEST(IncrementCovariance, PredictionLeavesAllOpen) {
  const Matrix6d Q = 0.01 * Matrix6d::Identity();
  FilterState state = measured(0.01);
  state.measurement_applied = false;
  setIncrementCovariance(IncrementFloor(), Q, 1.0, SweepPrediction(), state);
  EXPECT_NEAR(state.increment_covariance(0, 0), 0.01, 1e-12);
  EXPECT_NEAR(state.unobserved_covariance(0, 0), 0.01, 1e-12);
  EXPECT_TRUE(incrementOf(state).predicted);
}

TEST(IncrementCovariance, FloorAndScaleAreKept) {
  FilterState state = measured(1e-6);
  state.T_previous_now.translation().x() = 2.0;
  setIncrementCovariance({0.01, 0.005, 0.1}, 0.01 * Matrix6d::Identity(), 0.5, SweepPrediction(), state);
  EXPECT_NEAR(state.increment_covariance(0, 0), 0.02 * 0.02, 1e-9);
  EXPECT_NEAR(state.increment_covariance(5, 5), 0.01 * kDegree * kDegree, 1e-9);
  state.measurement_applied = false;
  setIncrementCovariance(IncrementFloor(), 0.01 * Matrix6d::Identity(), 0.5, SweepPrediction(), state);
  EXPECT_NEAR(state.increment_covariance(0, 0), 0.005, 1e-12);
}

TEST(IncrementCovariance, ConfirmedPoseIsOfTheMeasurement) {
  FilterState state = measured(0.01);
  EXPECT_FALSE(incrementOf(state).confirmed);
  state.fusion.confirmed = true;
  ASSERT_TRUE(incrementOf(state).confirmed);
  EXPECT_NEAR((*incrementOf(state).confirmed)(0, 0), 1e-4, 1e-9);
}

}  // namespace
}  // namespace fail_aware
