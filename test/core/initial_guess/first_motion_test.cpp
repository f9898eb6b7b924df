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

/// Near the start, at a distance of x_m from the last estimate.
InitialGuess guessNearStart(double x_m, std::optional<double> distance_m, double sigma_m) {
  InitialGuess guess = guessAt(x_m);
  guess.start = DriveOff::Place{distance_m, sigma_m};
  return guess;
}

TEST(FirstMotion, ADriveOffOverrulesAStandstillThatLittleInforms) {
  const MotionInitialization::Params params;
  Measurement standing = measuredAt(0.0);
  standing.covariance = 1e-4 * Matrix6d::Identity();
  standing.min_information_ratio = 0.05;
  addDriveOff(guessNearStart(0.8, 0.8, 0.05), params, standing);
  EXPECT_NEAR(standing.T_odom_cog.translation().x(), 0.8, 0.01);
  EXPECT_LT(standing.covariance(0, 0), 0.05 * 0.05);
  EXPECT_NEAR(standing.covariance(1, 1), 1e-4, 1e-12);

  Measurement agreeing = measuredAt(0.78);
  agreeing.covariance = 1e-4 * Matrix6d::Identity();
  addDriveOff(guessNearStart(0.8, 0.8, 0.05), params, agreeing);
  EXPECT_NEAR(agreeing.T_odom_cog.translation().x(), 0.78, 0.002) << "the more precise one";
}

TEST(FirstMotion, WithoutADistanceADriveOffIsDoubt) {
  const MotionInitialization::Params params;
  Measurement measurement = measuredAt(0.0);
  addDriveOff(guessNearStart(0.8, std::nullopt, 0.5), params, measurement);
  EXPECT_EQ(measurement.T_odom_cog.translation().x(), 0.0);
  EXPECT_NEAR(measurement.covariance(0, 0), 0.01 + 0.5 * 0.5, 1e-12);
  EXPECT_EQ(measurement.covariance(1, 1), 0.01);
}

TEST(FirstMotion, ADriveOffAddsNothingToMuchInformation) {
  const MotionInitialization::Params params;
  Measurement informed = measuredAt(0.0), missing = measuredAt(0.0), away = measuredAt(0.0);
  informed.min_information_ratio = 0.2;
  missing.status = MeasurementStatus::kNotConverged;
  addDriveOff(guessNearStart(0.8, 0.8, 0.05), params, informed);
  addDriveOff(guessNearStart(0.8, 0.8, 0.05), params, missing);
  addDriveOff(guessAt(0.8), params, away);
  for (const Measurement& measurement : {informed, missing, away}) {
    EXPECT_EQ(measurement.T_odom_cog.translation().x(), 0.0);
    EXPECT_EQ(measurement.covariance(0, 0), 0.01);
  }
}

TEST(FirstMotion, NearTheStartAStandstillNeedsLessInformation) {
  const MotionInitialization::Params params;
  for (const double ratio : {0.05, 0.1}) {
    Measurement measurement = measuredAt(0.0);
    measurement.min_information_ratio = ratio;
    inflateAlongTrack(guessNearStart(0.0, 0.0, 0.02), params, measurement);
    EXPECT_EQ(measurement.covariance(0, 0) > 1.0, ratio < 0.06) << ratio;
  }
  Measurement driving = measuredAt(0.25);
  inflateAlongTrack(guessNearStart(0.25, 0.25, 0.05), params, driving);
  EXPECT_EQ(driving.covariance(0, 0), 0.01) << "it does not stand";
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
