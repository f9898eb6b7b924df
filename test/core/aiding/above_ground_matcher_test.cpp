#include "core/aiding/above_ground_matcher.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "../../support/near_sides.hpp"
#include "../../support/synthetic_scene.hpp"
#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"
#include "core/map/above_ground_points.hpp"

namespace fail_aware::above_ground_matcher_test {
namespace {

using Points = std::vector<Eigen::Vector3f>;

/// 1.5 m high, on the ground at z = -1.
void addPost(double x, double y, Points& points) {
  for (int i = 0; i <= 15; ++i) points.emplace_back(Eigen::Vector3d(x, y, -1.0 + 0.1 * i).cast<float>());
}

Points posts() {
  Points points;
  for (const auto& [x, y] : {std::pair{12.0, 9.0}, {25.0, -14.0}, {38.0, 21.0}, {-17.0, 11.0}, {44.0, -5.0}}) {
    addPost(x, y, points);
  }
  return points;
}

/// A fence beside the road, along x, out of sight at both ends.
Points fence() {
  Points points;
  for (int i = -1200; i <= 1200; ++i) {
    for (int k = 0; k <= 10; ++k) points.emplace_back(Eigen::Vector3d(0.1 * i, 6.0, -1.0 + 0.1 * k).cast<float>());
  }
  return points;
}

Points seenAt(const Pose& T_odom_cog, const Points& points) {
  Points seen;
  const Pose T_cog_odom = T_odom_cog.inverse();
  for (const Eigen::Vector3f& p : points) seen.push_back((T_cog_odom * p.cast<double>()).cast<float>());
  return seen;
}

Pose planarPose(double x, double y, double yaw_rad) {
  Vector6d v = Vector6d::Zero();
  v << x, y, 0.0, 0.0, 0.0, yaw_rad;
  return poseFromVector(v);
}

/// All stands in these scenes, which is not the class's usual fare.
AboveGroundMatcher::Params anyRatio() {
  AboveGroundMatcher::Params params;
  params.reference.max_above_ground_ratio = 1.0;
  return params;
}

/// A match and the sweep that it is made with.
struct KeptMatch {
  AboveGroundMatcher match;
  AboveGroundReference reference;

  std::optional<AboveGroundPose> find(const Points& points_cog, const Pose& T_odom_cog_predicted) const {
    return match.find(match.select(points_cog), reference, T_odom_cog_predicted);
  }
};

KeptMatch matchAgainst(const Points& kept, const AboveGroundMatcher::Params& params = anyRatio()) {
  KeptMatch match{AboveGroundMatcher(params, IcpPointToPlane::Params()), AboveGroundReference(params.reference)};
  match.reference.keep(kept, Pose::Identity(), 0.0);
  return match;
}

Points joined(Points a, const Points& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(AboveGroundPoints, OnASlopeAPostStandsAndTheGroundDoesNot) {
  Points points;
  for (int x = -200; x <= 200; ++x) {
    for (int y = -20; y <= 20; ++y) {
      points.emplace_back(static_cast<float>(0.1 * x), static_cast<float>(0.1 * y), static_cast<float>(0.02 * x));
    }
  }
  const std::size_t ground = points.size();
  for (int i = 1; i <= 10; ++i) points.emplace_back(5.02f, 0.02f, 1.05f + 0.2f * static_cast<float>(i));
  const AboveGroundPoints standing = findAboveGroundPoints(points, {4.0, 0.5, 0.4}, 1000);
  ASSERT_EQ(standing.points.size(), 9u);  // from 0.4 m above the lowest of the column, 1 m high there
  for (const AboveGroundPoint& point : standing.points) EXPECT_NEAR(point.position.x(), 5.02, 1e-5);
  EXPECT_EQ(standing.places, 1u);
  EXPECT_EQ(standing.counts, std::vector<double>{9.0});
  EXPECT_NEAR(standing.ratio, 9.0 / static_cast<double>(ground + 10), 1e-12);
}

TEST(AboveGroundPoints, EnoughAreEveryNth) {
  Points points;
  for (int place = 0; place < 10; ++place) addPost(10.0 * place, 0.0, points);
  const AboveGroundPoints all = findAboveGroundPoints(points, {}, 1000), few = findAboveGroundPoints(points, {}, 40);
  EXPECT_EQ(all.places, 10u);
  EXPECT_GT(all.points.size(), 100u);
  EXPECT_LE(few.points.size(), 40u);
  EXPECT_EQ(few.places, 10u);
  EXPECT_DOUBLE_EQ(few.ratio, all.ratio);
  EXPECT_TRUE(findAboveGroundPoints({}, {}, 10).points.empty());
}

TEST(AboveGroundPoints, AnUnmetPointHasTheGivenVote) {
  Points posts;
  for (const double x : {5.0, 25.0}) addPost(x, 0.0, posts);
  const AboveGroundPoints seen = findAboveGroundPoints(posts, {}, 1000);
  ASSERT_EQ(seen.places, 2u);
  VoxelMap map(VoxelMap::Params{});
  Points first;
  addPost(5.0, 0.0, first);
  map.insert(first, Pose::Identity());
  const std::vector<double> votes = votesOfPlaces(seen, map, Pose::Identity(), 0.5);
  EXPECT_GT(votes[0], 0.8);
  EXPECT_EQ(votes[1], 0.0);
  const std::vector<double> told = votesOfPlaces(seen, map, Pose::Identity(), 0.5,
                                                 [](const Eigen::Vector3d& p) { return p.x() > 20.0 ? 0.7 : 9.0; });
  EXPECT_EQ(told[0], votes[0]);
  EXPECT_NEAR(told[1], 0.7, 1e-12);
}

TEST(AboveGroundMatcher, PostsTellPositionAndHeading) {
  const KeptMatch match = matchAgainst(posts());
  const Pose truth = planarPose(4.0, 0.3, 2.0 * kDegree), predicted = planarPose(4.7, 0.4, 1.7 * kDegree);
  const std::optional<AboveGroundPose> found = match.find(seenAt(truth, posts()), predicted);
  ASSERT_TRUE(found);
  EXPECT_LT((found->T_odom_cog.translation() - truth.translation()).norm(), 0.02);
  EXPECT_LT(logSo3(found->T_odom_cog.linear().transpose() * truth.linear()).norm(), 0.05 * kDegree);
  const Eigen::Vector3d variances = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(found->covariance).eigenvalues();
  EXPECT_GT(variances[0], 0.0);
  EXPECT_NEAR(std::sqrt(found->covariance(0, 0)), 0.10 / std::sqrt(5.0), 0.012);  // five places, 0.10 m each
  EXPECT_LT(std::sqrt(found->covariance(2, 2)), 0.5 * kDegree);
}

TEST(AboveGroundMatcher, HeightRollAndPitchStayAsPredicted) {
  const KeptMatch match = matchAgainst(posts());
  Vector6d v;
  v << 4.5, 0.0, 0.1, 0.01, 0.0, 0.0;
  const Pose predicted = poseFromVector(v);
  const std::optional<AboveGroundPose> found = match.find(seenAt(planarPose(4.0, 0.0, 0.0), posts()), predicted);
  ASSERT_TRUE(found);
  EXPECT_DOUBLE_EQ(found->T_odom_cog.translation().z(), 0.1);
  const Eigen::Vector3d down = found->T_odom_cog.linear().row(2), down_predicted = predicted.linear().row(2);
  EXPECT_LT((down - down_predicted).norm(), 2e-3);  // turned about the vertical alone
}

TEST(AboveGroundMatcher, AFenceAlongTheRoadTellsNothing) {
  const KeptMatch match = matchAgainst(fence());
  EXPECT_FALSE(match.find(seenAt(planarPose(4.0, 0.0, 0.0), fence()), planarPose(4.5, 0.0, 0.0)));
}

TEST(AboveGroundMatcher, BesideAFencePostsStillTell) {
  const Points scene = joined(fence(), posts());
  const KeptMatch match = matchAgainst(scene);
  const std::optional<AboveGroundPose> found =
      match.find(seenAt(planarPose(4.0, 0.0, 0.0), scene), planarPose(4.5, 0.0, 0.0));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->T_odom_cog.translation().x(), 4.0, 0.05);
}

TEST(AboveGroundMatcher, CarAheadIsNoProofOfStandstill) {
  Points car;
  for (const double y : {-0.8, -0.4, 0.0, 0.4, 0.8}) addPost(15.0, y, car);
  const Pose truth = planarPose(4.0, 0.0, 0.0);
  const KeptMatch alone = matchAgainst(car);
  EXPECT_FALSE(alone.find(car, truth));
  const KeptMatch match = matchAgainst(joined(car, posts()));
  const std::optional<AboveGroundPose> found =
      match.find(joined(car, seenAt(truth, posts())), planarPose(3.6, 0.0, 0.0));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->T_odom_cog.translation().x(), 4.0, 0.03);
}

TEST(AboveGroundMatcher, OnePlaceIsTooFew) {
  Points post;
  addPost(20.0, 5.0, post);
  const KeptMatch match = matchAgainst(post);
  EXPECT_FALSE(match.find(post, Pose::Identity()));
}

TEST(AboveGroundMatcher, NothingKeptNothingFound) {
  const KeptMatch match{AboveGroundMatcher(anyRatio(), IcpPointToPlane::Params()),
                        AboveGroundReference(anyRatio().reference)};
  EXPECT_FALSE(match.find(posts(), Pose::Identity()));
}

TEST(AboveGroundMatcher, OfASweepInWhichMuchStandsNothingIsKept) {
  EXPECT_FALSE(matchAgainst(posts(), AboveGroundMatcher::Params()).find(posts(), Pose::Identity()));
  EXPECT_TRUE(matchAgainst(posts()).find(posts(), Pose::Identity()));
}

TEST(AboveGroundMatcher, PlanesOfARoomOrAWallTellAndThoseOfAFieldDoNot) {
  const AboveGroundMatcher match{AboveGroundMatcher::Params(), IcpPointToPlane::Params()};
  const Scene field = {ground(-20.0, -20.0, 20.0, 20.0)};
  const auto ratioIn = [&](const Scene& scene) {
    VoxelMap map;
    const Points points = seenFrom(sampleScene(scene, 40.0, 0.01, 1), Pose::Identity());
    map.insert(points, Pose::Identity());
    return match.ratioOfPlanes(points, map, Pose::Identity(), 0.01);
  };
  EXPECT_GT(ratioIn(room()), 0.2);
  Scene road = field;
  road.push_back(wall(-20.0, 5.0, 20.0, 5.0, 3.0));
  EXPECT_GT(ratioIn(road), 0.2) << "across the road";
  EXPECT_LT(ratioIn(field), 0.001);
  EXPECT_EQ(match.ratioOfPlanes(posts(), VoxelMap(), Pose::Identity(), 0.01), 0.0);
}

TEST(AboveGroundMatcher, NearSidesOfPostsDoNotShortenTheWay) {
  AboveGroundMatcher::Params params = anyRatio();
  params.min_contrast = 0.0;
  double sum_m = 0.0;
  constexpr int kWays = 10;
  for (int i = 1; i <= kWays; ++i) {
    const Pose T_odom_cog = planarPose(1.0 * i, 0.0, 0.0);
    const auto found =
        matchAgainst(nearSidesSeenAt(Pose::Identity()), params).find(nearSidesSeenAt(T_odom_cog), T_odom_cog);
    ASSERT_TRUE(found);
    sum_m += found->T_odom_cog.translation().x() / T_odom_cog.translation().x() - 1.0;
  }
  EXPECT_NEAR(sum_m / kWays, 0.0, 4e-4);  // -9e-4 without allowing for them
}

}  // namespace
}  // namespace fail_aware::above_ground_matcher_test
