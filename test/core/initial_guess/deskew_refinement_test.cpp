#include "core/initial_guess/deskew_refinement.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "../../support/synthetic_drive.hpp"
#include "core/geometry/degree.hpp"
#include "core/preprocessing/correction.hpp"

namespace fail_aware::deskew_refinement_test {
namespace {

struct Look {
  std::vector<Eigen::Vector3f> points_cog;
  std::vector<float> times_s;
};

/// The sweep at the origin of a drive with `twist_cog`, corrected for `assumed_cog`.
Look lookOf(const Vector6d& twist_cog, const Vector6d& assumed_cog) {
  SyntheticDrive drive;
  drive.scene = room();
  drive.points_per_m2 = 60.0;
  drive.T_cog_lidar = Pose::Identity();
  drive.twist_cog = twist_cog;
  const CorrectedSweep sweep = drive.sweep(0.0, 2);
  Look look{sweep.points_lidar, sweep.times_s};
  redeskewBy(look.points_cog, look.times_s, assumed_cog);
  return look;
}

/// Few of its patches bend around an edge, which would pull to one side.
VoxelMap roomMap(const Pose& T_odom_room = Pose::Identity()) {
  VoxelMap::Params params;
  params.voxel_size_m = 0.8;
  params.max_plane_sigma_m = 0.03;
  VoxelMap map(params);
  map.insert(seenFrom(sampleScene(room(), 60.0, 0.01, 1), Pose::Identity()), T_odom_room);
  return map;
}

/// The data alone: a prior so wide that it does not count in so small a scene.
DeskewRefinement::Params wide() {
  DeskewRefinement::Params params;
  params.sigma_deg_s = 100.0;
  return params;
}

std::optional<Eigen::Vector3d> found(const Look& look, const Pose& start = Pose::Identity(),
                                     const DeskewRefinement::Params& params = wide()) {
  return DeskewRefinement(params, IcpPointToPlane::Params())
      .find(look.points_cog, look.times_s, 0.0, roomMap(), start, 0.0);
}

Vector6d turning(double roll_deg_s, double pitch_deg_s, double yaw_deg_s) {
  Vector6d twist = planarTwist(8.0, yaw_deg_s * kDegree);
  twist[3] = roll_deg_s * kDegree;
  twist[4] = pitch_deg_s * kDegree;
  return twist;
}

// Against the same sweep corrected rightly: where planes meet, the map's patches are not quite the walls.
TEST(DeskewRefinement, FindsTheRateThatTheSweepWasNotCorrectedFor) {
  const Vector6d assumed = turning(0.0, 0.0, 5.0);
  for (const Vector6d& truth : {turning(0.0, 0.0, 9.0), turning(0.0, 0.0, 2.0), turning(1.5, -2.0, 5.0)}) {
    const Pose start = poseOf(0.05, -0.03, 0.0, 0.0, 0.0, 0.2);
    const auto rate = found(lookOf(truth, assumed), start), nothing = found(lookOf(truth, truth), start);
    ASSERT_TRUE(rate && nothing);
    const Eigen::Vector3d missing = (truth - assumed).tail<3>();
    EXPECT_LT((*rate - *nothing - missing).norm() / kDegree, 0.4) << "found " << rate->transpose() / kDegree;
  }
}

TEST(DeskewRefinement, LeavesARightCorrectionAlone) {
  const Vector6d twist = turning(0.0, 0.0, 12.0);
  const auto rate = found(lookOf(twist, twist), Pose::Identity(), DeskewRefinement::Params());
  ASSERT_TRUE(rate);
  EXPECT_LT(std::abs(rate->z()) / kDegree, 0.3);
  EXPECT_LT(rate->norm() / kDegree, 1.0);
}

TEST(DeskewRefinement, RatesAreAboutTheVehiclesAxes) {
  const Look look = lookOf(turning(3.0, 0.0, 0.0), turning(0.0, 0.0, 0.0));
  const Pose heading = poseOf(3.0, 4.0, 0.0, 0.0, 0.0, 90.0);
  const auto rate = DeskewRefinement(wide(), IcpPointToPlane::Params())
                        .find(look.points_cog, look.times_s, 0.0, roomMap(heading), heading, 0.0);
  ASSERT_TRUE(rate);
  EXPECT_NEAR(rate->x() / kDegree, 3.0, 1.0);
  EXPECT_NEAR(rate->y() / kDegree, 0.0, 1.0);
}

// What was measured at middle_s is the sweep's fixed point: with another one the same rate is found.
TEST(DeskewRefinement, TimesCountFromTheMiddle) {
  Look look = lookOf(turning(0.0, 0.0, 9.0), turning(0.0, 0.0, 5.0));
  const auto usual = found(look);
  for (float& time_s : look.times_s) time_s += 0.05f;
  const auto shifted = DeskewRefinement(wide(), IcpPointToPlane::Params())
                           .find(look.points_cog, look.times_s, 0.05, roomMap(), Pose::Identity(), 0.0);
  ASSERT_TRUE(usual && shifted);
  EXPECT_LT((*usual - *shifted).norm() / kDegree, 0.01);
}

TEST(DeskewRefinement, TheNarrowerThePriorTheNearerThePrediction) {
  const Look look = lookOf(turning(0.0, 0.0, 9.0), turning(0.0, 0.0, 5.0));
  DeskewRefinement::Params usual, narrow;
  narrow.sigma_deg_s = 1e-3;
  const auto by_usual = found(look, Pose::Identity(), usual), by_narrow = found(look, Pose::Identity(), narrow);
  ASSERT_TRUE(by_usual && by_narrow);
  EXPECT_GT(by_usual->z() / kDegree, 2.0);
  EXPECT_LT(by_usual->z() / kDegree, 4.0);
  EXPECT_LT(by_narrow->norm() / kDegree, 0.05);
}

TEST(DeskewRefinement, WithoutTimesPlanesOrPointsThereIsNothing) {
  const Look look = lookOf(turning(0.0, 0.0, 9.0), turning(0.0, 0.0, 5.0));
  EXPECT_FALSE(found({look.points_cog, {}}));
  EXPECT_FALSE(found({{}, {}}));
  EXPECT_FALSE(found(look, poseOf(500.0, 0.0, 0.0, 0.0, 0.0, 0.0)));
  DeskewRefinement::Params off;
  off.enabled = false;
  EXPECT_FALSE(found(look, Pose::Identity(), off));
  const DeskewRefinement search{DeskewRefinement::Params(), IcpPointToPlane::Params()};
  EXPECT_FALSE(search.find(look.points_cog, look.times_s, 0.0, VoxelMap(), Pose::Identity(), 0.0));
  Look broken = look;
  broken.points_cog[7].x() = std::numeric_limits<float>::quiet_NaN();
  const auto rate = found(broken);
  EXPECT_TRUE(!rate || rate->allFinite());
}

TEST(DeskewRefinement, HalfARevolutionDoesNotTellTheRate) {
  const Look look = lookOf(turning(0.0, 0.0, 9.0), turning(0.0, 0.0, 5.0));
  Look half;
  for (std::size_t i = 0; i < look.points_cog.size(); ++i) {
    if (look.points_cog[i].y() < 0.0f) continue;
    half.points_cog.push_back(look.points_cog[i]);
    half.times_s.push_back(look.times_s[i]);
  }
  EXPECT_TRUE(found(look));
  EXPECT_FALSE(found(half));
}

TEST(DeskewRefinement, ARateBeyondFourSigmasIsRefused) {
  const Look look = lookOf(turning(0.0, 0.0, 30.0), turning(0.0, 0.0, 0.0));
  DeskewRefinement::Params params;
  params.sigma_deg_s = 6.0;
  const auto rate = found(look);
  ASSERT_TRUE(rate);
  EXPECT_GT(rate->z() / kDegree, 25.0);
  EXPECT_FALSE(found(look, Pose::Identity(), params));
}

}  // namespace
}  // namespace fail_aware::deskew_refinement_test
