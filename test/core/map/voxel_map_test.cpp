#include "core/map/voxel_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::voxel_map_test {
namespace {

using Points = std::vector<Eigen::Vector3f>;

VoxelMap::Params testParams() {
  VoxelMap::Params params;
  params.voxel_size_m = 1.0;
  params.max_points = 12;
  params.min_point_spacing_m = 0.1;
  params.min_plane_samples = 8;
  params.max_samples = 200;
  params.max_plane_sigma_m = 0.12;
  params.min_plane_flatness = 5.0;
  return params;
}

Pose translationPose(double x, double y, double z) {
  Pose T = Pose::Identity();
  T.translation() << x, y, z;
  return T;
}

/// A patch of 0.8 m x 0.8 m with the normal `n`, about `centre`, with noise along the normal.
Points patch(const Eigen::Vector3f& centre, const Eigen::Vector3f& n, int count, float sigma, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> in_plane(-0.4f, 0.4f);
  std::normal_distribution<float> noise(0.0f, 1.0f);
  const Eigen::Vector3f normal = n.normalized();
  const Eigen::Vector3f u = normal.unitOrthogonal(), v = normal.cross(u);
  Points points;
  for (int i = 0; i < count; ++i) {
    const float a = in_plane(generator), b = in_plane(generator);
    points.push_back(centre + a * u + b * v + sigma * noise(generator) * normal);
  }
  return points;
}

Points randomPoints(std::size_t count, float half_width, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> coordinate(-half_width, half_width);
  Points points(count);
  for (Eigen::Vector3f& p : points) p = {coordinate(generator), coordinate(generator), coordinate(generator)};
  return points;
}

bool findPlane(const VoxelMap& map, const Eigen::Vector3d& query, VoxelMap::PlaneMatch& match) {
  VoxelMap::Neighborhood neighborhood;
  return map.findPlane(query, match, neighborhood);
}

TEST(VoxelMap, FitsAPlaneWithItsScatter) {
  const Eigen::Vector3f n = Eigen::Vector3f(0.2f, -0.1f, 1.0f).normalized(), centre(0.5f, 0.5f, 0.5f);
  constexpr float kSigma = 0.03f;
  VoxelMap map(testParams());
  map.insert(patch(centre, n, 190, kSigma, 1), Pose::Identity());
  VoxelMap::PlaneMatch match;
  ASSERT_TRUE(findPlane(map, Eigen::Vector3d(0.5, 0.5, 0.5), match));
  EXPECT_NEAR(match.plane->normal.norm(), 1.0f, 1e-6f);
  EXPECT_GT(std::abs(match.plane->normal.dot(n)), std::cos(2.0 * kDegree));
  EXPECT_NEAR(std::sqrt(match.plane->variance), kSigma, 0.15f * kSigma);
  EXPECT_NEAR(match.distance_m, 0.0f, 0.01f);
  // the distance is signed, along the normal, and has the query's change along it
  VoxelMap::PlaneMatch moved;
  ASSERT_TRUE(findPlane(map, Eigen::Vector3d(0.5, 0.5, 0.5) + 0.2 * match.plane->normal.cast<double>(), moved));
  EXPECT_NEAR(moved.distance_m - match.distance_m, 0.2f, 1e-5f);
}

TEST(VoxelMap, KnowsHowFarItsNormalsAreTiltedByChance) {
  constexpr int kPatches = 400, kSamples = 30;
  const Eigen::Vector3f n = Eigen::Vector3f::UnitX(), centre(0.5f, 0.5f, 0.5f);
  double scatter = 0.0, told = 0.0;
  for (int i = 0; i < kPatches; ++i) {
    VoxelMap map(testParams());
    map.insert(patch(centre, n, kSamples, 0.05f, static_cast<unsigned>(i)), Pose::Identity());
    VoxelMap::PlaneMatch match;
    ASSERT_TRUE(findPlane(map, centre.cast<double>(), match));
    scatter += match.plane->normal.y() * match.plane->normal.y() / kPatches;
    told += match.plane->normal_variance / kPatches;
  }
  EXPECT_NEAR(told / scatter, 1.2, 0.25) << "about the axis that is known worse, so somewhat more";
}

TEST(VoxelMap, TheSameSweepTurnedGivesTurnedPlanes) {
  const Points points = patch({0.5f, 0.5f, 0.5f}, {0.0f, 0.0f, 1.0f}, 100, 0.01f, 2);
  const Pose T = poseFromVector((Vector6d() << 3.0, -4.0, 1.0, M_PI / 2.0, 0.0, 0.7).finished());
  VoxelMap map(testParams());
  map.insert(points, T);
  VoxelMap::PlaneMatch match;
  ASSERT_TRUE(findPlane(map, T * Eigen::Vector3d(0.5, 0.5, 0.5), match));
  EXPECT_GT(std::abs(match.plane->normal.cast<double>().dot(T.linear().col(2))), 0.999);
}

TEST(VoxelMap, ALineIsNoPlane) {
  Points line;
  for (int i = 0; i < 80; ++i) line.emplace_back(0.1f + 0.01f * static_cast<float>(i), 0.5f, 0.5f);
  VoxelMap map(testParams());
  map.insert(line, Pose::Identity());
  VoxelMap::PlaneMatch match;
  EXPECT_FALSE(findPlane(map, Eigen::Vector3d(0.5, 0.5, 0.5), match));
  // nor with the noise of a lidar
  std::mt19937 generator(3);
  std::normal_distribution<float> noise(0.0f, 0.02f);
  for (Eigen::Vector3f& p : line) p += Eigen::Vector3f(noise(generator), noise(generator), noise(generator));
  VoxelMap noisy(testParams());
  noisy.insert(line, Pose::Identity());
  EXPECT_FALSE(findPlane(noisy, Eigen::Vector3d(0.5, 0.5, 0.5), match));
}

TEST(VoxelMap, AnUprightLineIsAPost) {
  std::mt19937 generator(3);
  std::normal_distribution<float> noise(0.0f, 0.03f);
  for (const bool upright : {true, false}) {
    Points line;
    for (int i = 0; i < 80; ++i) {
      const float along = 0.1f + 0.01f * static_cast<float>(i);
      line.emplace_back((upright ? 0.5f : along) + noise(generator), 0.5f + noise(generator),
                        (upright ? along : 0.5f) + noise(generator));
    }
    VoxelMap map(testParams());
    map.insert(line, Pose::Identity());
    VoxelMap::PointMatch match;
    ASSERT_TRUE(map.findNearest(Eigen::Vector3d(0.5, 0.5, 0.5), 0.5, match));
    EXPECT_EQ(map.surface(match.voxel).samples, 0.0f);
    EXPECT_EQ(map.surface(match.voxel).post, upright);
  }
  VoxelMap plane(testParams());
  plane.insert(patch({0.5f, 0.5f, 0.5f}, {1.0f, 0.0f, 0.0f}, 100, 0.01f, 6), Pose::Identity());
  VoxelMap::PointMatch match;
  ASSERT_TRUE(plane.findNearest(Eigen::Vector3d(0.5, 0.5, 0.5), 0.5, match));
  EXPECT_GT(plane.surface(match.voxel).samples, 0.0f);
  EXPECT_FALSE(plane.surface(match.voxel).post);
}

TEST(VoxelMap, AThickPatchIsNoPlane) {
  VoxelMap::Params params = testParams();
  params.min_plane_flatness = 1.5;  // flat enough, but thick
  for (const float sigma : {0.10f, 0.14f}) {
    VoxelMap::PlaneMatch match;
    VoxelMap map(params);
    map.insert(patch({0.5f, 0.5f, 0.5f}, {0.0f, 0.0f, 1.0f}, 150, sigma, 4), Pose::Identity());
    EXPECT_EQ(findPlane(map, Eigen::Vector3d(0.5, 0.5, 0.5), match), sigma < 0.12f) << sigma;
  }
}

TEST(VoxelMap, FewPointsAreNoPlane) {
  VoxelMap::PlaneMatch match;
  VoxelMap map(testParams());
  const Points points = patch({0.5f, 0.5f, 0.5f}, {0.0f, 1.0f, 0.0f}, 8, 0.0f, 5);
  map.insert(Points(points.begin(), points.begin() + 7), Pose::Identity());
  EXPECT_FALSE(findPlane(map, Eigen::Vector3d(0.5, 0.5, 0.5), match));
  map.insert(Points(points.begin() + 7, points.end()), Pose::Identity());
  EXPECT_TRUE(findPlane(map, Eigen::Vector3d(0.5, 0.5, 0.5), match));
  EXPECT_EQ(match.plane->samples, 8.0f);
}

TEST(VoxelMap, PlanesSharpenAsPointsCome) {
  const Eigen::Vector3f n(0.0f, 0.0f, 1.0f);
  VoxelMap map(testParams());
  map.insert(patch({0.5f, 0.5f, 0.4f}, n, 20, 0.01f, 6), Pose::Identity());
  map.insert(patch({0.5f, 0.5f, 0.5f}, n, 60, 0.01f, 7), Pose::Identity());
  VoxelMap::PlaneMatch match;
  ASSERT_TRUE(findPlane(map, Eigen::Vector3d(0.5, 0.5, 0.5), match));
  EXPECT_EQ(match.plane->samples, 80.0f);
  EXPECT_NEAR(std::abs(match.distance_m), 0.025f, 0.005f);  // the mean of all 80
}

TEST(VoxelMap, IsFrozenAfterMaxSamples) {
  VoxelMap::Params params = testParams();
  params.max_samples = 50;
  params.max_points = 20;
  params.min_point_spacing_m = 0.3;
  VoxelMap map(params);
  const Eigen::Vector3f n(0.0f, 0.0f, 1.0f);
  map.insert(patch({0.5f, 0.5f, 0.3f}, n, 80, 0.005f, 8), Pose::Identity());
  VoxelMap::PlaneMatch before, after;
  ASSERT_TRUE(findPlane(map, Eigen::Vector3d(0.5, 0.5, 0.5), before));
  const PlanePatch frozen = *before.plane;
  EXPECT_EQ(frozen.samples, 50.0f);
  const std::vector<Eigen::Vector3d> stored = map.points();
  EXPECT_LT(stored.size(), 20u);
  map.insert(patch({0.5f, 0.5f, 0.8f}, n, 80, 0.005f, 9), Pose::Identity());
  ASSERT_TRUE(findPlane(map, Eigen::Vector3d(0.5, 0.5, 0.5), after));
  EXPECT_EQ(after.plane->samples, frozen.samples);
  EXPECT_EQ(after.distance_m, before.distance_m);
  EXPECT_EQ(after.plane->variance, frozen.variance);
  EXPECT_EQ(map.points(), stored);
}

TEST(VoxelMap, IsFrozenWithAllItsSamples) {
  VoxelMap::Params params = testParams();
  params.max_samples = 50;
  VoxelMap map(params);
  const Points points = patch({0.5f, 0.5f, 0.5f}, {0.0f, 0.0f, 1.0f}, 50, 0.01f, 25);
  map.insert(Points(points.begin(), points.begin() + 45), Pose::Identity());
  map.insert(Points(points.begin() + 45, points.end()), Pose::Identity());
  VoxelMap::PlaneMatch match;
  ASSERT_TRUE(findPlane(map, Eigen::Vector3d(0.5, 0.5, 0.5), match));
  EXPECT_EQ(match.plane->samples, 50.0f);
}

TEST(VoxelMap, StoredPointsKeepTheirSpacingAndNumber) {
  VoxelMap map(testParams());
  const Points points = randomPoints(5000, 2.0f, 10);
  map.insert(points, Pose::Identity());
  const std::vector<Eigen::Vector3d> stored = map.points();
  EXPECT_EQ(map.size(), 64u);
  EXPECT_EQ(stored.size(), 64u * 12u);
  for (std::size_t i = 0; i < stored.size(); ++i) {
    for (std::size_t j = i + 1; j < stored.size() && (stored[i].array().floor() == stored[j].array().floor()).all();
         ++j) {
      EXPECT_GE((stored[i] - stored[j]).norm(), 0.1 - 1e-6);
    }
  }
}

TEST(VoxelMap, NearestIsExactWithinHalfAVoxel) {
  for (const double size : {1.0, 0.4}) {
    VoxelMap::Params params = testParams();
    params.voxel_size_m = size;
    params.min_point_spacing_m = 0.0;
    params.max_points = VoxelMap::kMaxPoints;
    VoxelMap map(params);
    map.insert(randomPoints(300, 2.0f, 11), Pose::Identity());
    const std::vector<Eigen::Vector3d> stored = map.points();
    std::mt19937 generator(12);
    std::uniform_real_distribution<double> coordinate(-2.3, 2.3);
    int compared = 0;
    for (int k = 0; k < 2000; ++k) {
      const Eigen::Vector3d query(coordinate(generator), coordinate(generator), coordinate(generator));
      Eigen::Vector3d best = stored.front() - query;
      for (const Eigen::Vector3d& p : stored) {
        if ((p - query).squaredNorm() < best.squaredNorm()) best = p - query;
      }
      VoxelMap::PointMatch match;
      const bool found = map.findNearest(query, 0.5 * size, match);
      ASSERT_EQ(found, best.norm() < 0.5 * size) << query.transpose();
      if (!found) continue;
      ++compared;
      EXPECT_LT((match.offset_m.cast<double>() - best).norm(), 1e-5);
      EXPECT_NEAR(match.distance2_m2, best.squaredNorm(), 1e-5);
    }
    EXPECT_GT(compared, 150);
  }
}

TEST(VoxelMap, AnswersTheSameWithANeighborhoodThatGoesAlong) {
  VoxelMap::Params params = testParams();
  params.min_plane_samples = 3;
  params.max_plane_sigma_m = 1.0;
  params.min_plane_flatness = 1.0;
  for (const int max_points : {12, 10, VoxelMap::kMaxPoints}) {
    params.max_points = max_points;
    VoxelMap map(params);
    map.insert(randomPoints(400, 3.0f, 21), Pose::Identity());
    std::mt19937 generator(22);
    std::normal_distribution<double> step(0.0, 0.05);
    int planes = 0, nearest = 0;
    VoxelMap::Neighborhood neighborhood;  // of all queries: what they ask for, and where, must not matter
    for (const Eigen::Vector3f& begin : randomPoints(50, 3.0f, 23)) {
      Eigen::Vector3d query = begin.cast<double>();
      for (int k = 0; k < 100; ++k) {
        for (int axis = 0; axis < 3; ++axis) query[axis] += step(generator);
        if (k == 50) query = query.array().round();        // a corner
        if (k == 60) query = query.array().floor() + 0.5;  // a centre
        if (k == 70) query.x() = -0.0;                     // a face
        const Eigen::Vector3d asked = k == 80 ? Eigen::Vector3d::Constant(NAN) : query;
        VoxelMap::PlaneMatch plane, plane_alone;
        const bool has_plane = map.findPlane(asked, plane, neighborhood);
        ASSERT_EQ(has_plane, findPlane(map, asked, plane_alone)) << asked.transpose();
        VoxelMap::PointMatch point, point_alone;
        const bool has_point = map.findNearest(asked, 0.4, point, neighborhood);
        ASSERT_EQ(has_point, map.findNearest(asked, 0.4, point_alone)) << asked.transpose();
        map.prefetchPlane(neighborhood);
        map.prefetchPoints(neighborhood);
        if (has_plane) {
          ASSERT_EQ(plane.plane, plane_alone.plane) << asked.transpose();
          EXPECT_EQ(plane.distance_m, plane_alone.distance_m);
          ++planes;
        }
        if (has_point) {
          ASSERT_EQ(point.voxel, point_alone.voxel) << asked.transpose();
          EXPECT_EQ(point.offset_m, point_alone.offset_m);
          ++nearest;
        }
      }
    }
    EXPECT_GT(planes, 1000);
    EXPECT_GT(nearest, 500);
    EXPECT_LT(nearest, 4900);
  }
}

TEST(VoxelMap, NearestKeepsToTheDistanceLimit) {
  VoxelMap map(testParams());
  map.insert({{0.5f, 0.5f, 0.5f}}, Pose::Identity());
  VoxelMap::PointMatch match;
  EXPECT_TRUE(map.findNearest(Eigen::Vector3d(0.5, 0.5, 0.9), 0.41, match));
  EXPECT_LT((match.offset_m - Eigen::Vector3f(0.0f, 0.0f, -0.4f)).norm(), 1e-6f);
  EXPECT_FALSE(map.findNearest(Eigen::Vector3d(0.5, 0.5, 0.9), 0.39, match));
}

TEST(VoxelMap, FindsPlanesAcrossTheNearFaceOnly) {
  VoxelMap map(testParams());
  map.insert(patch({1.5f, 0.5f, 0.5f}, {0.0f, 0.0f, 1.0f}, 100, 0.005f, 13), Pose::Identity());  // voxel (1, 0, 0)
  VoxelMap::PlaneMatch match;
  EXPECT_TRUE(findPlane(map, Eigen::Vector3d(0.9, 0.5, 0.4), match));
  EXPECT_NEAR(std::abs(match.distance_m), 0.1f, 0.01f);
  EXPECT_TRUE(findPlane(map, Eigen::Vector3d(2.1, 0.5, 0.5), match));
  EXPECT_TRUE(findPlane(map, Eigen::Vector3d(1.5, -0.1, 0.5), match));
  EXPECT_TRUE(findPlane(map, Eigen::Vector3d(1.5, 0.5, 1.1), match));
  EXPECT_FALSE(findPlane(map, Eigen::Vector3d(0.4, 0.5, 0.5), match));  // nearer to the other face
  EXPECT_FALSE(findPlane(map, Eigen::Vector3d(0.9, 1.1, 0.5), match));  // shares only an edge
  EXPECT_FALSE(findPlane(map, Eigen::Vector3d(-0.9, 0.5, 0.5), match));
}

TEST(VoxelMap, PrefersItsOwnVoxelThenTheNearestFace) {
  VoxelMap map(testParams());
  map.insert(patch({1.5f, 0.5f, 0.5f}, {1.0f, 0.0f, 0.0f}, 100, 0.005f, 14), Pose::Identity());
  map.insert(patch({0.5f, 1.5f, 0.5f}, {0.0f, 1.0f, 0.0f}, 100, 0.005f, 15), Pose::Identity());
  map.insert(patch({0.5f, 0.5f, 1.5f}, {0.0f, 0.0f, 1.0f}, 100, 0.005f, 16), Pose::Identity());
  VoxelMap::PlaneMatch match;
  const auto axisFound = [&](double x, double y, double z) {
    int axis = -1;
    if (findPlane(map, Eigen::Vector3d(x, y, z), match)) match.plane->normal.cwiseAbs().maxCoeff(&axis);
    return axis;
  };
  EXPECT_EQ(axisFound(0.9, 0.8, 0.7), 0);
  EXPECT_EQ(axisFound(0.9, 0.7, 0.8), 0);
  EXPECT_EQ(axisFound(0.8, 0.9, 0.7), 1);
  EXPECT_EQ(axisFound(0.7, 0.9, 0.8), 1);
  EXPECT_EQ(axisFound(0.8, 0.7, 0.9), 2);
  EXPECT_EQ(axisFound(0.7, 0.8, 0.9), 2);
  EXPECT_EQ(axisFound(0.05, 0.7, 0.8), 2);  // nothing across the nearest face: the next one
  EXPECT_EQ(axisFound(1.05, 0.5, 0.95), 0);
}

TEST(VoxelMap, NegativeCoordinatesAreLikePositiveOnes) {
  Points points = patch({0.5f, 0.5f, 0.5f}, {0.3f, 0.2f, 1.0f}, 100, 0.01f, 17);
  VoxelMap positive(testParams()), negative(testParams());
  positive.insert(points, translationPose(5.0, 7.0, 3.0));
  negative.insert(points, translationPose(-5.0, -7.0, -3.0));
  for (const Eigen::Vector3d& local : {Eigen::Vector3d(0.5, 0.5, 0.6), Eigen::Vector3d(0.2, 0.9, 0.5),
                                       Eigen::Vector3d(0.5, 0.5, 1.2), Eigen::Vector3d(-0.1, 0.5, 0.5)}) {
    VoxelMap::PlaneMatch a, b;
    ASSERT_TRUE(findPlane(positive, local + Eigen::Vector3d(5.0, 7.0, 3.0), a));
    ASSERT_TRUE(findPlane(negative, local - Eigen::Vector3d(5.0, 7.0, 3.0), b));
    EXPECT_NEAR(a.distance_m, b.distance_m, 1e-5f);
    EXPECT_GT(a.plane->normal.dot(b.plane->normal), 0.99999f);
    EXPECT_NEAR(a.plane->variance, b.plane->variance, 1e-6f);
  }
}

TEST(VoxelMap, IsAsPreciseFarFromTheOrigin) {
  const Points points = patch({0.5f, 0.5f, 0.5f}, {0.3f, 0.2f, 1.0f}, 100, 0.005f, 18);
  const Eigen::Vector3d far(5000.0, -5000.0, 120.0), query(0.45, 0.52, 0.55);
  VoxelMap near_map(testParams()), far_map(testParams());
  near_map.insert(points, Pose::Identity());
  far_map.insert(points, translationPose(far.x(), far.y(), far.z()));
  VoxelMap::PlaneMatch a, b;
  ASSERT_TRUE(findPlane(near_map, query, a));
  ASSERT_TRUE(findPlane(far_map, far + query, b));
  EXPECT_NEAR(a.distance_m, b.distance_m, 1e-6f);
  EXPECT_GT(a.plane->normal.dot(b.plane->normal), 1.0f - 1e-6f);
  EXPECT_NEAR(a.plane->variance, b.plane->variance, 1e-7f);
  VoxelMap::PointMatch c, d;
  ASSERT_TRUE(near_map.findNearest(query, 0.5, c));
  ASSERT_TRUE(far_map.findNearest(far + query, 0.5, d));
  EXPECT_LT((c.offset_m - d.offset_m).norm(), 1e-6f);
}

TEST(VoxelMap, ForgetsFarVoxelsAndKeepsTheRestIntact) {
  VoxelMap map(testParams());
  Points points;
  for (int x = -30; x < 30; ++x) {
    const Points some = patch({static_cast<float>(x) + 0.5f, 0.5f, 0.5f}, {0.1f * static_cast<float>(x), 0.0f, 1.0f},
                              30, 0.01f, static_cast<unsigned>(x + 100));
    points.insert(points.end(), some.begin(), some.end());
  }
  map.insert(points, Pose::Identity());
  const VoxelMap all = map;
  const Eigen::Vector3d position(2.0, 0.5, 0.5);
  map.removeFartherThan(10.0, position);
  EXPECT_LT(map.size(), all.size());
  std::size_t kept_points = 0;
  for (const Eigen::Vector3d& p : all.points()) {
    const Eigen::Vector3d centre = p.array().floor() + 0.5;
    kept_points += (centre - position).norm() <= 10.0 ? 1 : 0;
  }
  EXPECT_EQ(map.points().size(), kept_points);
  for (double x = -29.5; x < 30.0; x += 1.0) {
    const Eigen::Vector3d query(x, 0.5, 0.5);
    VoxelMap::PlaneMatch a, b;
    VoxelMap::PointMatch c, d;
    if ((query - position).norm() > 11.5) {
      EXPECT_FALSE(findPlane(map, query, b)) << x;
      EXPECT_FALSE(map.findNearest(query, 0.5, d)) << x;
    } else if ((query - position).norm() < 9.0) {
      ASSERT_TRUE(findPlane(all, query, a)) << x;
      ASSERT_TRUE(findPlane(map, query, b)) << x;
      EXPECT_EQ(a.distance_m, b.distance_m) << x;
      EXPECT_EQ(a.plane->normal, b.plane->normal) << x;
      ASSERT_TRUE(all.findNearest(query, 1.0, c)) << x;
      ASSERT_TRUE(map.findNearest(query, 1.0, d)) << x;
      EXPECT_EQ(c.offset_m, d.offset_m) << x;
    }
  }
}

TEST(VoxelMap, GrowsAgainWhereItHasForgotten) {
  VoxelMap map(testParams());
  map.insert(patch({0.5f, 0.5f, 0.5f}, {0.0f, 0.0f, 1.0f}, 50, 0.01f, 20), Pose::Identity());
  map.insert(patch({20.5f, 0.5f, 0.5f}, {0.0f, 0.0f, 1.0f}, 50, 0.01f, 21), Pose::Identity());
  map.removeFartherThan(5.0, Eigen::Vector3d(20.0, 0.0, 0.0));
  EXPECT_EQ(map.size(), 1u);
  map.insert(patch({0.5f, 0.5f, 0.5f}, {0.0f, 1.0f, 0.0f}, 50, 0.01f, 22), Pose::Identity());
  EXPECT_EQ(map.size(), 2u);
  VoxelMap::PlaneMatch match;
  ASSERT_TRUE(findPlane(map, Eigen::Vector3d(0.5, 0.5, 0.5), match));
  EXPECT_EQ(match.plane->samples, 50.0f);
  EXPECT_GT(std::abs(match.plane->normal.y()), 0.99f);
  ASSERT_TRUE(findPlane(map, Eigen::Vector3d(20.5, 0.5, 0.5), match));
  EXPECT_GT(std::abs(match.plane->normal.z()), 0.99f);
}

TEST(VoxelMap, RefusesWhatIsNotFinite) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  const Points good = patch({0.5f, 0.5f, 0.5f}, {0.0f, 0.0f, 1.0f}, 50, 0.01f, 23);
  Points points = {{nan, 0.5f, 0.5f}, {0.5f, nan, 0.5f}, {0.5f, 0.5f, -infinity}, {infinity, nan, 0.0f}};
  points.insert(points.end(), good.begin(), good.end());
  VoxelMap clean(testParams()), map(testParams());
  clean.insert(good, Pose::Identity());
  map.insert(points, Pose::Identity());
  EXPECT_EQ(map.size(), clean.size());
  EXPECT_EQ(map.points(), clean.points());
  VoxelMap::PlaneMatch match;
  ASSERT_TRUE(findPlane(map, Eigen::Vector3d(0.5, 0.5, 0.5), match));
  EXPECT_EQ(match.plane->samples, 50.0f);
  EXPECT_TRUE(match.plane->normal.allFinite());
  map.insert(good, translationPose(0.0, std::numeric_limits<double>::quiet_NaN(), 0.0));
  EXPECT_EQ(map.points(), clean.points());
}

TEST(VoxelMap, HasNothingForQueriesThatAreNotFinite) {
  VoxelMap map(testParams());
  map.insert(patch({0.5f, 0.5f, 0.5f}, {0.0f, 0.0f, 1.0f}, 50, 0.01f, 26), Pose::Identity());
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1e30}) {
    VoxelMap::PlaneMatch plane;
    VoxelMap::PointMatch point;
    for (int axis = 0; axis < 3; ++axis) {
      Eigen::Vector3d query(0.5, 0.5, 0.5);
      query[axis] = bad;
      EXPECT_FALSE(findPlane(map, query, plane));
      EXPECT_FALSE(map.findNearest(query, 1.0, point));
    }
  }
}

TEST(VoxelMap, IsEmptyAfterClear) {
  VoxelMap map(testParams());
  EXPECT_TRUE(map.empty());
  map.insert(randomPoints(100, 1.0f, 24), Pose::Identity());
  EXPECT_FALSE(map.empty());
  map.clear();
  EXPECT_TRUE(map.empty());
  EXPECT_TRUE(map.points().empty());
  VoxelMap::PointMatch match;
  EXPECT_FALSE(map.findNearest(Eigen::Vector3d::Zero(), 1.0, match));
}

TEST(VoxelMap, WhatIsReservedStaysWhereItIs) {
  VoxelMap map(testParams());
  map.reserve(5000);
  map.insert(randomPoints(1, 100.0f, 25), Pose::Identity());
  const PlanePatch* const first = &map.surface(0);
  map.insert(randomPoints(4000, 100.0f, 26), Pose::Identity());
  EXPECT_GT(map.size(), 3000u);
  EXPECT_EQ(&map.surface(0), first);
}

TEST(VoxelMap, ValidatesItsParameters) {
  const auto rejects = [](auto change) {
    VoxelMap::Params params = testParams();
    change(params);
    EXPECT_THROW(validate(params), ParameterError);
  };
  EXPECT_NO_THROW(validate(VoxelMap::Params()));
  rejects([](VoxelMap::Params& p) { p.voxel_size_m = 0.0; });
  rejects([](VoxelMap::Params& p) { p.min_plane_samples = 2; });
  rejects([](VoxelMap::Params& p) { p.max_samples = p.min_plane_samples - 1; });
}

}  // namespace
}  // namespace fail_aware::voxel_map_test
