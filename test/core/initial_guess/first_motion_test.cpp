#include "core/initial_guess/first_motion.hpp"

#include <gtest/gtest.h>

namespace fail_aware::first_motion_test {
namespace {

Measurement measuredAt(double x_m) {
  Measurement measurement;
  measurement.status = MeasurementStatus::kOk;
  measurement.T_odom_cog.translation().x() = x_m;
  measurement.covariance = 0.01 * Matrix6d::Identity();
  return measurement;
}

InitialGuess guessAt(double x_m) {
  InitialGuess guess;
  guess.T_odom_cog.translation().x() = x_m;
  guess.dt_s = 0.1;
  return guess;
}

TEST(FirstMotion, ASearchedPositionCountsAsMeasured) {
  InitialGuess guess = guessAt(2.0);
  Measurement measurement = measuredAt(1.0);
  addSearchedMotion(guess, measurement);
  EXPECT_EQ(measurement.T_odom_cog.translation().x(), 1.0) << "nothing was searched";
  guess.searched_sigma_m = 0.1;
  addSearchedMotion(guess, measurement);
  EXPECT_NEAR(measurement.T_odom_cog.translation().x(), 1.5, 1e-12);
  EXPECT_NEAR(measurement.covariance(0, 0), 0.005, 1e-12);
}

// The Kalman filter with one scalar measurement in x; the one in y knows nothing.
TEST(FirstMotion, WhatIsCorrelatedMovesAlong) {
  InitialGuess guess = guessAt(2.0);
  guess.searched_sigma_m = 1.0;
  Measurement measurement = measuredAt(1.0);
  measurement.covariance = Matrix6d::Identity();
  measurement.covariance(0, 5) = measurement.covariance(5, 0) = 0.5;
  addSearchedMotion(guess, measurement);
  EXPECT_NEAR(measurement.covariance(5, 5), 1.0 - 0.5 * 0.5 / 2.0, 1e-12);
  EXPECT_NEAR(measurement.covariance(0, 5), 0.5 - 0.5 * 0.5, 1e-12);
  EXPECT_GT(measurement.T_odom_cog.linear()(1, 0), 0.2) << "it turned to the left";
  EXPECT_EQ(measurement.covariance, measurement.covariance.transpose().eval());
}

TEST(FirstMotion, StandstillIsDoubtedWhereLittleInforms) {
  const MotionInitialization::Params params;
  Measurement measurement = measuredAt(0.2);
  measurement.min_information_ratio = 0.1;
  inflateAlongTrack(guessAt(0.0), params, measurement);
  EXPECT_NEAR(measurement.covariance(0, 0), 0.01 + 4.5 * 4.5, 1e-9);
  EXPECT_EQ(measurement.covariance(1, 1), 0.01);
  EXPECT_EQ(measurement.degenerate_directions, 1);
  EXPECT_EQ(measurement.min_information_ratio, 0.0);
}

TEST(FirstMotion, AMotionOrMuchInformationIsNotDoubted) {
  const MotionInitialization::Params params;
  for (const double distance_m : {0.35, 0.05}) {
    Measurement measurement = measuredAt(distance_m);
    measurement.min_information_ratio = distance_m > 0.3 ? 0.0 : 0.3;
    inflateAlongTrack(guessAt(0.0), params, measurement);
    EXPECT_EQ(measurement.covariance(0, 0), 0.01) << distance_m;
    EXPECT_EQ(measurement.degenerate_directions, 0);
  }
}

TEST(FirstMotion, WithoutAPoseNothingIsAdded) {
  InitialGuess guess = guessAt(2.0);
  guess.searched_sigma_m = 0.1;
  Measurement measurement = measuredAt(0.0);
  measurement.status = MeasurementStatus::kNotConverged;
  addSearchedMotion(guess, measurement);
  inflateAlongTrack(guess, MotionInitialization::Params(), measurement);
  EXPECT_EQ(measurement.T_odom_cog.translation().x(), 0.0);
  EXPECT_EQ(measurement.covariance(0, 0), 0.01);
}

}  // namespace
}  // namespace fail_aware::first_motion_test
