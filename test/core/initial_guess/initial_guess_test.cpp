#include "core/initial_guess/initial_guess.hpp"
#include "core/registration_parameters.hpp"

#include <gtest/gtest.h>

#include "../../support/synthetic_drive.hpp"

namespace fail_aware::initial_guess_test {
namespace {

using Found = InitialGuess::Found;

/// A vehicle at 12 m/s whose first sweep, at the origin, is in the map.
class InitialGuessTest : public ::testing::Test {
 protected:
  InitialGuessTest()
      : builder_(RegistrationCloudBuilder(params().cloud), {params().beam_bias, params().icp_point_to_plane}),
        resolver_({params().initialization, params().cloud.min_range_m},
                  {params().relocalization, params().icp_point_to_point},
                  {params().deskew_refinement, params().icp_point_to_plane}),
        map_(params().reference, params().above_ground.reference) {
    drive_.twist_cog = planarTwist(12.0, 0.2);
  }

  static RegistrationParameters params() {
    RegistrationParameters params;
    params.cloud.max_range_m = 60.0;
    params.initialization.max_range_m = 40.0;
    return params;
  }

  /// The guess for the sweep at stamp_s, predicted at T_odom_cog.
  InitialGuess resolve(double stamp_s, double dt_s, const Pose& T_odom_cog, bool motion_known, double sigma_m = 0.01) {
    SweepPrediction prediction;
    prediction.stamp_s = stamp_s;
    prediction.dt_s = dt_s;
    prediction.T_odom_cog_previous = drive_.pose(stamp_s - dt_s);
    prediction.T_odom_cog = T_odom_cog;
    prediction.covariance = sigma_m * sigma_m * Matrix6d::Identity();
    prediction.motion_status = motion_known ? MotionStatus::kObserved : MotionStatus::kUnknown;
    const bool stands = drive_.twist_cog.isZero();  // the beams hit the same spots
    const CorrectedSweep sweep = drive_.sweep(stamp_s, stands ? 2u : static_cast<unsigned>(2.0 + 10.0 * stamp_s));
    builder_.build(sweep, prediction, drive_.T_cog_lidar, scan_);
    return resolver_.resolve(sweep, scan_, map_, track_, prediction);
  }

  void placeFirst() {
    const InitialGuess guess = resolve(0.0, 0.0, Pose::Identity(), false);
    EXPECT_EQ(guess.twist_found, Found::kNothing);
    FilterState state;
    state.measurement_applied = true;
    state.map_update = MapUpdate::kInsert;
    track_.add(state);
    map_.insert(scan_.cloud, Pose::Identity(), 0.0, true);
  }

  SyntheticDrive drive_;
  RegistrationScanBuilder builder_;
  RegistrationScan scan_;
  InitialGuessResolver resolver_;
  LocalMap map_;
  EstimateTrack track_;
};

TEST_F(InitialGuessTest, TheSearchFindsTheFirstMotion) {
  placeFirst();
  const InitialGuess guess = resolve(0.1, 0.1, Pose::Identity(), false);
  EXPECT_EQ(guess.twist_found, Found::kFirstMotion);
  EXPECT_NEAR(guess.twist_cog[0], 12.0, 1.0);
  EXPECT_LT(translationError(guess.T_odom_cog, drive_.pose(0.1)), 0.1);
  EXPECT_GT(guess.searched_sigma_m, 0.0);
  EXPECT_NEAR(guess.covariance(0, 0), 0.04, 1e-9) << "a step of the search, squared";
  EXPECT_FALSE(guess.lost);
}

TEST_F(InitialGuessTest, ADriveOffIsFollowedWithTheFirstSweep) {
  drive_.twist_cog.setZero();
  placeFirst();
  resolve(0.1, 0.1, Pose::Identity(), false);
  InitialGuess guess = resolve(0.2, 0.1, Pose::Identity(), true);
  ASSERT_TRUE(guess.start);
  EXPECT_EQ(guess.start->distance_m, 0.0);
  EXPECT_TRUE(guess.T_odom_cog.isApprox(Pose::Identity()));

  drive_.twist_cog = planarTwist(1.5, 0.2);
  const Pose behind = drive_.pose(1.0) * Eigen::Translation3d(-0.2, 0.0, 0.0);
  guess = resolve(1.0, 0.1, behind, true);
  ASSERT_TRUE(guess.start && guess.start->distance_m);
  EXPECT_NEAR(*guess.start->distance_m, 1.5, 0.1);
  EXPECT_LT(translationError(guess.T_odom_cog, drive_.pose(1.0)), 0.12) << "along the arc";
  EXPECT_TRUE(resolver_.mayDriveOff());

  guess = resolve(6.0, 0.1, drive_.pose(6.0), true);
  EXPECT_FALSE(guess.start) << "9 m away";
  EXPECT_EQ(guess.T_odom_cog.matrix(), drive_.pose(6.0).matrix());
}

TEST_F(InitialGuessTest, AResetOfOdomWhileStandingBeginsAnew) {
  drive_.twist_cog.setZero();
  placeFirst();
  resolve(0.1, 0.1, Pose::Identity(), false);
  EXPECT_TRUE(resolve(0.2, 0.1, Pose::Identity(), true).start);
  map_.enterOdom(1);
  EXPECT_FALSE(resolve(5.0, 0.1, Pose::Identity(), true).start) << "this sweep is the first in the new map";
  map_.insert(scan_.cloud, Pose::Identity(), 5.0, true);
  EXPECT_FALSE(resolve(5.1, 0.1, Pose::Identity(), true).start);
  EXPECT_TRUE(resolve(5.2, 0.1, Pose::Identity(), true).start);
}

TEST_F(InitialGuessTest, AVehicleInMotionIsNotFollowed) {
  placeFirst();
  resolve(0.1, 0.1, Pose::Identity(), false);
  for (const double stamp_s : {0.2, 0.3, 0.4}) EXPECT_FALSE(resolve(stamp_s, 0.1, drive_.pose(stamp_s), true).start);
}

TEST_F(InitialGuessTest, OnceMotionIsKnownItIsThePrediction) {
  placeFirst();
  const Pose predicted = drive_.pose(0.1);
  const InitialGuess guess = resolve(0.1, 0.1, predicted, true);
  EXPECT_EQ(guess.T_odom_cog.matrix(), predicted.matrix());
  EXPECT_EQ(guess.searched_sigma_m, 0.0);
  EXPECT_FALSE(guess.clock_jump_suspected);
  EXPECT_FALSE(guess.lost);
  EXPECT_EQ(guess.dt_s, 0.1);
}

TEST_F(InitialGuessTest, AfterAGapThePlaceIsSearchedFor) {
  placeFirst();
  track_.add(FilterState());  // not measured
  const Pose truth = drive_.pose(0.2), predicted = poseOf(1.6, 0.4, 0.0, 0.0, 0.0, 0.0);
  const InitialGuess guess = resolve(0.2, 0.1, predicted, true, 0.3);
  EXPECT_FALSE(guess.lost);
  EXPECT_LT(translationError(guess.T_odom_cog, truth), 0.3);
  EXPECT_GT(translationError(predicted, truth), 0.8);
}

TEST_F(InitialGuessTest, WhereNothingIsFoundAfterAGapTrackingIsLost) {
  placeFirst();
  track_.add(FilterState());
  const Pose elsewhere = poseOf(500.0, 0.0, 0.0, 0.0, 0.0, 0.0);
  const InitialGuess guess = resolve(0.2, 0.1, elsewhere, true, 0.5);
  EXPECT_TRUE(guess.lost);
  EXPECT_EQ(guess.T_odom_cog.matrix(), elsewhere.matrix());
  EXPECT_EQ(guess.twist_found, Found::kNothing);
}

}  // namespace
}  // namespace fail_aware::initial_guess_test
