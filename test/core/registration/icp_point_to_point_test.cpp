#include "core/registration/icp_point_to_point.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "../../support/expect_usable.hpp"
#include "../../support/near_sides.hpp"
#include "../../support/synthetic_scene.hpp"
#include "core/geometry/decompositions.hpp"
#include "core/geometry/degree.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::icp_point_to_point_test {
namespace {

using Points = std::vector<Eigen::Vector3f>;

constexpr double kNoise_m = 0.01;

IcpPointToPoint::Params testParams() {
  IcpPointToPoint::Params params;
  params.seeds = 8;
  params.spread = 1.0;
  params.min_spread_m = 0.05;
  params.min_spread_deg = 0.1;
  params.max_spread_m = 1.0;
  params.max_spread_deg = 3.0;
  params.thinned_points = 500;
  params.max_distance_m = 0.5;
  params.kernel_m = 0.2;
  params.initial_kernel_m = 0.4;
  params.merge_translation_m = 0.02;
  params.merge_rotation_deg = 0.1;
  params.max_joint_iterations = 12;
  params.max_refined_seeds = 3;
  params.max_iterations = 40;
  params.min_inliers = 100;
  params.min_inlier_ratio = 0.3;
  return params;
}

VoxelMap mapOf(const std::vector<Eigen::Vector3d>& points, const Pose& T_odom_cog) {
  VoxelMap::Params params;
  params.voxel_size_m = 0.5;
  params.max_points = VoxelMap::kMaxPoints;
  params.min_point_spacing_m = 0.05;
  params.min_plane_samples = 4;  // the scenes are sampled that thinly
  VoxelMap map(params);
  map.insert(seenFrom(points, T_odom_cog), Pose::Identity());
  return map;
}

Matrix6d covarianceOf(double sigma_x, double sigma_y, double sigma_z, double sigma_yaw_deg) {
  Vector6d sigmas;
  sigmas << sigma_x, sigma_y, sigma_z, 0.01, 0.01, sigma_yaw_deg * kDegree;
  return sigmas.cwiseAbs2().asDiagonal();
}

TEST(IcpPointToPoint, SeedsLieOneSigmaOff) {
  const IcpPointToPoint icp(testParams());
  const Pose T = poseOf(10.0, 20.0, 1.0, 0.0, 0.0, 90.0);
  const std::vector<Pose> seeds = icp.seeds(T, covarianceOf(0.2, 0.6, 0.1, 1.5));
  ASSERT_EQ(seeds.size(), 8u);
  // heading 90 deg: odom's y is the body's x
  const std::vector<Vector6d> expected = [] {
    std::vector<Vector6d> offsets;
    const auto add = [&](int axis, double size) {
      for (const double sign : {1.0, -1.0}) offsets.push_back(sign * size * Vector6d::Unit(axis));
    };
    add(0, 0.6);
    add(1, 0.2);
    add(2, 0.1);
    add(5, 1.5 * kDegree);
    return offsets;
  }();
  for (const Vector6d& offset : expected) {
    int found = 0;
    for (const Pose& seed : seeds) found += (vectorFromPose(T.inverse() * seed) - offset).norm() < 1e-9 ? 1 : 0;
    EXPECT_EQ(found, 1) << offset.transpose();
  }
}

TEST(IcpPointToPoint, TheSeedsScatterAsThePredictionDoes) {
  // the mean is the prediction, and the scatter over x and y that of the covariance, whatever the heading
  const IcpPointToPoint icp(testParams());
  const Pose T = poseOf(0.0, 0.0, 0.0, 0.0, 0.0, 30.0);
  const Matrix6d body = covarianceOf(0.5, 0.2, 0.1, 1.0);
  const Matrix6d P = rotateCovariance(body, T.linear());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Pose& seed : icp.seeds(T, P)) {
    mean += seed.translation() / 8.0;
    scatter += 0.5 * seed.translation() * seed.translation().transpose();
  }
  EXPECT_LT(mean.norm(), 1e-12);
  EXPECT_LT((scatter - P.topLeftCorner<3, 3>()).norm(), 1e-9);
}

TEST(IcpPointToPoint, TheSpreadScalesAndHasLimits) {
  IcpPointToPoint::Params params = testParams();
  params.spread = 2.0;
  const auto farthest = [&](const Matrix6d& P, bool rotation) {
    double most = 0.0;
    for (const Pose& seed : IcpPointToPoint(params).seeds(Pose::Identity(), P)) {
      most = std::max(most, rotation ? rotationErrorDeg(seed, Pose::Identity()) : seed.translation().norm());
    }
    return most;
  };
  EXPECT_NEAR(farthest(covarianceOf(0.3, 0.1, 0.1, 1.2), false), 0.6, 1e-9);
  EXPECT_NEAR(farthest(covarianceOf(0.3, 0.1, 0.1, 1.2), true), 2.4, 1e-6);
  EXPECT_NEAR(farthest(covarianceOf(1e-4, 1e-4, 1e-4, 1e-4), false), 0.05, 1e-9);
  EXPECT_NEAR(farthest(covarianceOf(1e-4, 1e-4, 1e-4, 1e-4), true), 0.1, 1e-6);
  EXPECT_NEAR(farthest(covarianceOf(10.0, 10.0, 10.0, 30.0), false), 1.0, 1e-9);
  EXPECT_NEAR(farthest(covarianceOf(10.0, 10.0, 10.0, 30.0), true), 3.0, 1e-6);
}

TEST(IcpPointToPoint, FewerSeedsTakeTheLikelierErrors) {
  IcpPointToPoint::Params params = testParams();
  params.seeds = 1;
  const Pose T = poseOf(1.0, 2.0, 3.0, 0.0, 0.0, 10.0);
  const std::vector<Pose> one = IcpPointToPoint(params).seeds(T, covarianceOf(1.0, 1.0, 1.0, 1.0));
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].matrix(), T.matrix());
  params.seeds = 2;
  const std::vector<Pose> two = IcpPointToPoint(params).seeds(T, covarianceOf(0.3, 0.3, 0.3, 1.0));
  ASSERT_EQ(two.size(), 2u);
  EXPECT_LT(((T.inverse() * two[0]).translation() - Eigen::Vector3d(0.3, 0.0, 0.0)).norm(), 1e-9);
  EXPECT_LT(((T.inverse() * two[1]).translation() + Eigen::Vector3d(0.3, 0.0, 0.0)).norm(), 1e-9);
  params.seeds = 5;
  EXPECT_EQ(IcpPointToPoint(params).seeds(T, covarianceOf(0.3, 0.3, 0.3, 1.0)).size(), 5u);
}

TEST(IcpPointToPoint, RecoversKnownMotionsBothWays) {
  IcpPointToPoint::Params params = testParams();
  params.step_translation_m =
      5e-4;  // point to point creeps along a street: one seed stops 0.1 m short of it: one seed stops 0.1 m short
  params.step_rotation_deg = 0.005;
  params.max_iterations = 100;
  const Pose T_a_b = poseOf(0.25, -0.1, 0.02, 0.1, -0.2, 1.0);
  for (const bool in_a_room : {true, false}) {
    const Scene scene = in_a_room ? room() : street();
    const std::vector<Eigen::Vector3d> first = sampleScene(scene, 20.0, kNoise_m, 1);
    const std::vector<Eigen::Vector3d> second = sampleScene(scene, 20.0, kNoise_m, 2);
    const Points in_a = seenFrom(first, Pose::Identity(), 20.0), in_b = seenFrom(second, T_a_b, 20.0);
    Points few_a, few_b;
    for (std::size_t i = 0; i < in_a.size(); i += 20) few_a.push_back(in_a[i]);
    for (std::size_t i = 0; i < in_b.size(); i += 20) few_b.push_back(in_b[i]);
    const VoxelMap map_a = mapOf(first, Pose::Identity()), map_b = mapOf(second, T_a_b);
    const Matrix6d P = covarianceOf(0.2, 0.1, 0.05, 0.5);
    for (const int seeds : {1, 8}) {
      if (seeds == 1 && !in_a_room) continue;
      params.seeds = seeds;
      const IcpPointToPoint icp(params);
      const Measurement forward = icp.align(few_b, map_a, Pose::Identity(), P);
      const Measurement backward = icp.align(few_a, map_b, Pose::Identity(), P);
      for (const auto& [measured, truth] :
           {std::make_pair(forward, T_a_b), std::make_pair(backward, T_a_b.inverse())}) {
        ASSERT_TRUE(measured.ok()) << toString(measured.status);
        EXPECT_LT(translationError(measured.T_odom_cog, truth), 0.05) << seeds;
        EXPECT_LT(rotationErrorDeg(measured.T_odom_cog, truth), 0.2) << seeds;
        EXPECT_GT(measured.inlier_ratio, 0.8);
        expectUsable(measured);
      }
    }
  }
}

TEST(IcpPointToPoint, TracksTellWhereEachSeedBeganAndEnded) {
  const IcpPointToPoint icp(testParams());
  const VoxelMap map = mapOf(sampleScene(room(), 25.0, kNoise_m, 1), Pose::Identity());
  const Points points = seenFrom(sampleScene(room(), 2.0, kNoise_m, 2), Pose::Identity());
  const Pose T0 = poseOf(0.05, -0.05, 0.0, 0.0, 0.0, 0.3);
  const Matrix6d P = covarianceOf(0.2, 0.2, 0.05, 0.5);
  std::vector<SeedTrack> tracks(3);
  const Measurement m = icp.align(points, map, T0, P, &tracks);
  ASSERT_TRUE(m.ok()) << toString(m.status);
  const std::vector<Pose> seeds = icp.seeds(T0, P);
  ASSERT_EQ(tracks.size(), seeds.size());
  int winners = 0;
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    EXPECT_EQ(tracks[i].T_odom_cog_seed.matrix(), seeds[i].matrix());
    EXPECT_LT(translationError(tracks[i].T_odom_cog_end, Pose::Identity()), 0.1) << "one basin";
    if (!tracks[i].won) continue;
    ++winners;
    EXPECT_EQ(tracks[i].T_odom_cog_end.matrix(), m.T_odom_cog.matrix());
  }
  EXPECT_GT(winners, 0);
  const Measurement unwatched = icp.align(points, map, T0, P);
  EXPECT_EQ(unwatched.T_odom_cog.matrix(), m.T_odom_cog.matrix()) << "looking changes nothing";

  icp.align(points, VoxelMap(), T0, P, &tracks);
  EXPECT_TRUE(tracks.empty()) << "no reference";
  icp.align(Points(20, Eigen::Vector3f(500, 500, 500)), map, T0, P, &tracks);
  ASSERT_EQ(tracks.size(), 8u);
  for (const SeedTrack& track : tracks) EXPECT_FALSE(track.won);
}

// One Gauss-Newton step against numerically differentiated offsets to the nearest points at the start.
TEST(IcpPointToPoint, AStepIsThatOfFiniteDifferences) {
  IcpPointToPoint::Params params = testParams();
  params.seeds = 1;
  params.max_iterations = 1;
  params.relaxed_convergence_factor = 1e6;
  params.observability.min_information_ratio = 0.0;
  params.surface_information = false;
  params.usual_curvature_ratio = 0.0;
  const VoxelMap map = mapOf(sampleScene(room(), 25.0, kNoise_m, 1), Pose::Identity());
  const Pose T0 = poseOf(0.1, -0.05, 0.03, 0.3, -0.2, 1.0);
  const Points points = seenFrom(sampleScene(room(), 2.0, kNoise_m, 2), poseOf(0.25, 0.1, 0.0, 0.0, 0.0, 0.0));
  const Measurement m = IcpPointToPoint(params).align(points, map, T0, covarianceOf(0.1, 0.1, 0.1, 0.1));
  ASSERT_TRUE(m.ok()) << toString(m.status);

  constexpr double kStep = 1e-5;
  Matrix6d H = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  std::size_t used = 0;
  double weights = 0.0, squares = 0.0;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d q = point.cast<double>();
    VoxelMap::PointMatch match;
    if (!map.findNearest(T0 * q, params.max_distance_m, match)) continue;
    ++used;
    const Eigen::Vector3d target = T0 * q + match.offset_m.cast<double>();
    const auto residual = [&](const Vector6d& dx) -> Eigen::Vector3d { return target - applyStep(T0, dx) * q; };
    Eigen::Matrix<double, 3, 6> J;
    for (int i = 0; i < 6; ++i) {
      J.col(i) = (residual(kStep * Vector6d::Unit(i)) - residual(-kStep * Vector6d::Unit(i))) / (2.0 * kStep);
    }
    const Eigen::Vector3d r = residual(Vector6d::Zero());
    const double kernel = 0.04 / (0.04 + r.squaredNorm());
    const double weight = kernel * kernel;
    H += weight * J.transpose() * J;
    b -= weight * J.transpose() * r;
    weights += weight;
    squares += weight * r.squaredNorm();
  }
  EXPECT_EQ(m.inliers, used);
  EXPECT_NEAR(m.rms_residual_m, std::sqrt(squares / weights), 1e-6);
  const Vector6d dx = solutionOf(H, b);
  EXPECT_GT(dx.norm(), 0.02);
  EXPECT_LT(translationError(m.T_odom_cog, applyStep(T0, dx)), 1e-6);
  EXPECT_LT(rotationErrorDeg(m.T_odom_cog, applyStep(T0, dx)), 1e-5);
  Vector6d factor;
  factor << 1.0, 1.0, 1.0, 4.0, 4.0, 1.0;  // roll and pitch follow the guess
  const Matrix6d expected = factor.asDiagonal() *
                            (inverseOf(H) * params.correlation_inflation * squares / weights / 3.0) *
                            factor.asDiagonal();
  EXPECT_LT((m.covariance - dx * dx.transpose() - expected).norm(), 1e-5 * expected.norm());
}

/// Posts every 1.2 m along both sides and one end wall: all posts but the last fit their neighbours, too.
Scene postsAndAnEnd() {
  Scene scene = {wall(9.5, -5.0, 9.5, 5.0, 3.0), wall(-9.5, -5.0, -9.5, -3.0, 3.0)};
  for (int k = -7; k <= 7; ++k) {
    for (const double side : {-6.0, 6.0}) addPost(scene, 1.2 * k, side, 0.15, 2.5);
  }
  return scene;
}

TEST(IcpPointToPoint, EightSeedsFindTheRightPosts) {
  const std::vector<Eigen::Vector3d> reference = sampleScene(postsAndAnEnd(), 60.0, kNoise_m, 1);
  const VoxelMap map = mapOf(reference, Pose::Identity());
  for (const double direction : {1.0, -1.0}) {
    const Pose truth = poseOf(0.7 * direction, 0.05, 0.0, 0.0, 0.0, 0.3);  // more than half a spacing off
    const Points points = seenFrom(sampleScene(postsAndAnEnd(), 25.0, kNoise_m, 2), truth);
    const Matrix6d P = covarianceOf(0.5, 0.1, 0.05, 0.5);
    IcpPointToPoint::Params params = testParams();
    params.seeds = 1;
    const Measurement one = IcpPointToPoint(params).align(points, map, Pose::Identity(), P);
    EXPECT_NEAR(one.T_odom_cog.translation().x(), (0.7 - 1.2) * direction, 0.1);  // one post too far back
    params.seeds = 8;
    const Measurement eight = IcpPointToPoint(params).align(points, map, Pose::Identity(), P);
    ASSERT_TRUE(eight.ok()) << toString(eight.status);
    EXPECT_LT(translationError(eight.T_odom_cog, truth), 0.05);
    EXPECT_LT(rotationErrorDeg(eight.T_odom_cog, truth), 0.3);
    EXPECT_GT(eight.inlier_ratio, one.inlier_ratio);
  }
}

TEST(IcpPointToPoint, NearSidesOfPostsHardlyShortenTheWay) {
  VoxelMap map;
  map.insert(nearSidesSeenAt(Pose::Identity()), Pose::Identity());
  IcpPointToPoint::Params params = testParams();
  params.seeds = 1;
  double sum = 0.0;
  constexpr int kWays = 10;
  for (int i = 1; i <= kWays; ++i) {
    const Pose truth = poseOf(1.0 * i, 0.0, 0.0, 0.0, 0.0, 0.0);
    const Measurement m =
        IcpPointToPoint(params).align(nearSidesSeenAt(truth), map, truth, covarianceOf(0.1, 0.1, 0.1, 0.1));
    ASSERT_TRUE(m.ok()) << toString(m.status);
    sum += m.T_odom_cog.translation().x() / i - 1.0;
  }
  EXPECT_NEAR(sum / kWays, 0.0, 5e-4);  // -8.5e-4 without allowing for them
}

TEST(IcpPointToPoint, SeedsThatDisagreeWidenTheCovariance) {
  // without the end wall each post fits its neighbour almost as well
  Scene posts = postsAndAnEnd();
  posts.erase(posts.begin(), posts.begin() + 2);
  const VoxelMap map = mapOf(sampleScene(posts, 60.0, kNoise_m, 1), Pose::Identity());
  const Points points = seenFrom(sampleScene(posts, 25.0, kNoise_m, 2), poseOf(0.6, 0.0, 0.0, 0.0, 0.0, 0.0));
  IcpPointToPoint::Params params = testParams();
  const Measurement ambiguous =
      IcpPointToPoint(params).align(points, map, Pose::Identity(), covarianceOf(0.5, 0.1, 0.05, 0.5));
  EXPECT_GT(ambiguous.seed_spread_m, 0.3);
  EXPECT_GT(std::sqrt(ambiguous.covariance(0, 0)), 0.3 / std::sqrt(3.0));
  expectUsable(ambiguous);
  params.seeds = 1;
  const Measurement one =
      IcpPointToPoint(params).align(points, map, Pose::Identity(), covarianceOf(0.5, 0.1, 0.05, 0.5));
  EXPECT_EQ(one.seed_spread_m, 0.0);
  EXPECT_LT(one.covariance(0, 0), ambiguous.covariance(0, 0));
}

TEST(IcpPointToPoint, SeedsThatMeetAreMergedAndCostAsOne) {
  const VoxelMap map = mapOf(sampleScene(room(), 40.0, kNoise_m, 1), Pose::Identity());
  const Pose truth = poseOf(0.1, 0.05, 0.0, 0.0, 0.0, 0.3);
  const Points points = seenFrom(sampleScene(room(), 4.0, kNoise_m, 2), truth);
  const Matrix6d P = covarianceOf(0.1, 0.05, 0.05, 0.2);
  IcpPointToPoint::Params params = testParams();
  params.max_refined_seeds = 8;
  params.merge_translation_m = 0.1;
  params.merge_rotation_deg = 0.5;
  const Measurement merged = IcpPointToPoint(params).align(points, map, Pose::Identity(), P);
  params.merge_translation_m = params.merge_rotation_deg = 0.0;
  const Measurement all = IcpPointToPoint(params).align(points, map, Pose::Identity(), P);
  params.seeds = 1;
  const Measurement one = IcpPointToPoint(params).align(points, map, Pose::Identity(), P);
  ASSERT_TRUE(merged.ok());
  ASSERT_TRUE(all.ok());
  ASSERT_TRUE(one.ok());
  EXPECT_LE(merged.iterations, one.iterations + 2);
  EXPECT_GE(all.iterations, 8);
  EXPECT_GT(all.iterations, 3 * merged.iterations);
  EXPECT_LT(translationError(merged.T_odom_cog, all.T_odom_cog), 0.01);
  EXPECT_EQ(merged.seed_spread_m, 0.0);
  EXPECT_LT(all.seed_spread_m, 0.02);
}

TEST(IcpPointToPoint, OnlyTheBestSeedsAreRefined) {
  const VoxelMap map = mapOf(sampleScene(postsAndAnEnd(), 60.0, kNoise_m, 1), Pose::Identity());
  const Pose truth = poseOf(0.7, 0.05, 0.0, 0.0, 0.0, 0.3);
  const Points points = seenFrom(sampleScene(postsAndAnEnd(), 25.0, kNoise_m, 2), truth);
  IcpPointToPoint::Params params = testParams();
  params.merge_translation_m = 0.0;
  params.max_refined_seeds = 1;
  const Measurement m = IcpPointToPoint(params).align(points, map, Pose::Identity(), covarianceOf(0.5, 0.1, 0.05, 0.5));
  ASSERT_TRUE(m.ok());
  EXPECT_EQ(m.seed_spread_m, 0.0);
  EXPECT_LT(translationError(m.T_odom_cog, truth), 0.05);
}

TEST(IcpPointToPoint, WithoutAReferenceItSaysSo) {
  const Pose start = poseOf(1.0, 2.0, 3.0, 0.0, 0.0, 40.0);
  const Measurement m =
      IcpPointToPoint(testParams())
          .align(Points(500, Eigen::Vector3f::Ones()), VoxelMap(), start, covarianceOf(0.1, 0.1, 0.1, 0.1));
  EXPECT_EQ(m.status, MeasurementStatus::kNoReference);
  EXPECT_EQ(m.T_odom_cog.matrix(), start.matrix());
}

TEST(IcpPointToPoint, TooFewPointsKeepThePrediction) {
  const VoxelMap map = mapOf(sampleScene(room(), 25.0, kNoise_m, 1), Pose::Identity());
  const Pose start = poseOf(0.1, 0.0, 0.0, 0.0, 0.0, 3.0), far = poseOf(500.0, 0.0, 0.0, 0.0, 0.0, 0.0);
  const Points points = seenFrom(sampleScene(room(), 2.0, kNoise_m, 2), start);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Points mostly_elsewhere = points;
  for (std::size_t i = 0; i < 4 * points.size(); ++i) mostly_elsewhere.emplace_back(70.0f, 0.0f, 0.0f);
  for (const int seeds : {1, 8}) {
    IcpPointToPoint::Params params = testParams();
    params.seeds = seeds;
    for (const auto& [cloud, pose] :
         {std::make_pair(Points(), start), std::make_pair(Points(points.begin(), points.begin() + 99), start),
          std::make_pair(points, far), std::make_pair(Points(1000, {nan, nan, nan}), start),
          std::make_pair(mostly_elsewhere, start)}) {
      const Measurement m = IcpPointToPoint(params).align(cloud, map, pose, covarianceOf(0.1, 0.1, 0.1, 0.1));
      EXPECT_EQ(m.status, MeasurementStatus::kTooFewPoints);
      EXPECT_EQ(m.T_odom_cog.matrix(), pose.matrix());
      expectUsable(m);
    }
  }
}

TEST(IcpPointToPoint, AlongACorridorNothingIsObserved) {
  IcpPointToPoint::Params params = testParams();
  const VoxelMap map = mapOf(sampleScene(corridor(), 100.0, kNoise_m, 1), Pose::Identity());
  const Pose T_true = poseOf(0.3, 0.05, 0.0, 0.0, 0.0, 0.3), T_predicted = poseOf(0.1, 0.0, 0.0, 0.0, 0.0, 0.0);
  const Points points = seenFrom(sampleScene(corridor(), 4.0, kNoise_m, 2), T_true, 30.0);
  const Matrix6d P = covarianceOf(0.2, 0.1, 0.05, 0.5);
  params.seeds = 1;
  const Measurement m = IcpPointToPoint(params).align(points, map, T_predicted, P);
  ASSERT_TRUE(m.ok()) << toString(m.status);
  EXPECT_EQ(m.degenerate_directions, 1);
  EXPECT_LT(m.min_information_ratio, 0.01);
  EXPECT_NEAR(m.T_odom_cog.translation().x(), 0.1, 0.02) << "it stays at the prediction";
  EXPECT_NEAR(m.T_odom_cog.translation().y(), 0.05, 0.02);
  EXPECT_NEAR(std::sqrt(m.covariance(0, 0)), params.observability.weak_sigma_m, 0.1);
  EXPECT_LT(std::sqrt(m.covariance(1, 1)), 0.05);

  params.surface_information = false;  // the article's: sure of a place that it made up
  const Measurement literal = IcpPointToPoint(params).align(points, map, T_predicted, P);
  EXPECT_EQ(literal.degenerate_directions, 0);
  EXPECT_LT(std::sqrt(literal.covariance(0, 0)), 0.05);
}

TEST(IcpPointToPoint, AVehicleAheadIsNoProofOfAPlaceAlongACorridor) {
  Scene scene = corridor();
  addPost(scene, 15.0, 0.0, 1.8, 1.5);
  const VoxelMap map = mapOf(sampleScene(scene, 100.0, kNoise_m, 1), Pose::Identity());
  const Points points = seenFrom(sampleScene(scene, 4.0, kNoise_m, 2), poseOf(0.1, 0.0, 0.0, 0.0, 0.0, 0.0), 30.0);
  IcpPointToPoint::Params params = testParams();
  params.seeds = 1;
  params.observability.min_information_ratio = 0.001;  // else its share is too small anyway
  const Matrix6d P = covarianceOf(0.2, 0.1, 0.05, 0.5);
  EXPECT_EQ(IcpPointToPoint(params).align(points, map, Pose::Identity(), P).degenerate_directions, 1);
  params.support.max_place_ratio = 1.0;
  EXPECT_EQ(IcpPointToPoint(params).align(points, map, Pose::Identity(), P).degenerate_directions, 0);
}

TEST(IcpPointToPoint, IterationLimitCostsCovariance) {
  const VoxelMap map = mapOf(sampleScene(room(), 25.0, kNoise_m, 1), Pose::Identity());
  const Points points = seenFrom(sampleScene(room(), 4.0, kNoise_m, 2), poseOf(0.3, 0.0, 0.0, 0.0, 0.0, 0.0));
  IcpPointToPoint::Params params = testParams();
  params.seeds = 1;
  params.max_iterations = 1;
  params.relaxed_convergence_factor = 1.0;
  params.correlation_inflation = 1.0;  // the step is longer than R's standard deviation
  const Matrix6d P = covarianceOf(0.1, 0.1, 0.1, 0.1);
  const Measurement stopped = IcpPointToPoint(params).align(points, map, Pose::Identity(), P);
  EXPECT_EQ(stopped.status, MeasurementStatus::kNotConverged);
  EXPECT_EQ(stopped.iterations, 1);
  expectUsable(stopped);
  params.relaxed_convergence_factor = 1e6;
  const Measurement accepted = IcpPointToPoint(params).align(points, map, Pose::Identity(), P);
  EXPECT_TRUE(accepted.ok());
  const double step_m = accepted.T_odom_cog.translation().x();
  EXPECT_GT(step_m, 0.005);
  EXPECT_GT(std::sqrt(accepted.covariance(0, 0)), step_m);
}

TEST(IcpPointToPoint, IsDeterministic) {
  const IcpPointToPoint icp(testParams());
  const VoxelMap map = mapOf(sampleScene(room(), 25.0, kNoise_m, 1), Pose::Identity());
  const Points points = seenFrom(sampleScene(room(), 2.0, kNoise_m, 2), poseOf(0.3, 0.0, 0.0, 0.0, 0.0, 0.0));
  const Matrix6d P = covarianceOf(0.3, 0.1, 0.1, 0.5);
  const Measurement a = icp.align(points, map, Pose::Identity(), P), b = icp.align(points, map, Pose::Identity(), P);
  EXPECT_EQ(a.T_odom_cog.matrix(), b.T_odom_cog.matrix());
  EXPECT_EQ(a.covariance, b.covariance);
}

TEST(IcpPointToPoint, ValidatesItsParameters) {
  const auto rejects = [](auto change) {
    IcpPointToPoint::Params params = testParams();
    change(params);
    EXPECT_THROW(validate(params), ParameterError);
  };
  EXPECT_NO_THROW(validate(IcpPointToPoint::Params()));
  rejects([](auto& p) { p.seeds = 9; });
  rejects([](auto& p) { p.seeds = 0; });
  rejects([](auto& p) { p.min_inlier_ratio = 1.5; });
}

}  // namespace
}  // namespace fail_aware::icp_point_to_point_test
