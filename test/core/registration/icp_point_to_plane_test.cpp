#include "core/registration/icp_point_to_plane.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "../../support/expect_usable.hpp"
#include "../../support/synthetic_scene.hpp"
#include "core/geometry/decompositions.hpp"
#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::icp_point_to_plane_test {
namespace {

using Points = std::vector<Eigen::Vector3f>;

constexpr double kNoise_m = 0.01;

IcpPointToPlane::Params testParams() {
  IcpPointToPlane::Params params;
  params.filter_normals = true;
  params.heading_tolerance_deg = 45.0;
  params.keep_ground = true;
  params.ground_tolerance_deg = 30.0;
  params.vertical_tolerance_deg = 30.0;
  params.max_distance_m = 0.8;
  params.kernel_m = 0.1;
  params.initial_kernel_m = 0.4;
  params.point_sigma_m = 0.03;
  params.ground_weight = 0.5;
  params.range_weight_m = 0.0;
  params.max_iterations = 30;
  params.min_inliers = 100;
  return params;
}

VoxelMap mapOf(const Points& points, const Pose& T_odom_points) {
  VoxelMap::Params params;
  params.voxel_size_m = 1.0;
  params.max_plane_sigma_m = 0.1;
  VoxelMap map(params);
  map.insert(points, T_odom_points);
  return map;
}

VoxelMap mapOf(const Scene& scene, unsigned seed) {
  return mapOf(seenFrom(sampleScene(scene, 25.0, kNoise_m, seed), Pose::Identity()), Pose::Identity());
}

Points sweepOf(const Scene& scene, const Pose& T_odom_cog, unsigned seed, double max_range_m = 30.0) {
  return seenFrom(sampleScene(scene, 4.0, kNoise_m, seed), T_odom_cog, max_range_m);
}

TEST(IcpPointToPlane, RecoversKnownMotionsBothWays) {
  const IcpPointToPlane icp(testParams());
  for (const Scene& scene : {room(), street()}) {
    for (const Pose& T_a_b : {poseOf(0.5, 0.1, 0.02, 0.2, -0.3, 2.0), poseOf(0.3, -0.4, -0.1, -0.5, 0.5, -3.0)}) {
      const std::vector<Eigen::Vector3d> first = sampleScene(scene, 25.0, kNoise_m, 1);
      const std::vector<Eigen::Vector3d> second = sampleScene(scene, 25.0, kNoise_m, 2);
      const Points in_a = seenFrom(first, Pose::Identity(), 40.0), in_b = seenFrom(second, T_a_b, 40.0);
      Points few_a, few_b;
      for (std::size_t i = 0; i < in_a.size(); i += 10) few_a.push_back(in_a[i]);
      for (std::size_t i = 0; i < in_b.size(); i += 10) few_b.push_back(in_b[i]);
      const Measurement forward = icp.align(few_b, mapOf(in_a, Pose::Identity()), Pose::Identity(), 0.0);
      const Measurement backward = icp.align(few_a, mapOf(in_b, Pose::Identity()), Pose::Identity(), 0.0);
      for (const auto& [measured, truth] :
           {std::make_pair(forward, T_a_b), std::make_pair(backward, T_a_b.inverse())}) {
        ASSERT_TRUE(measured.ok()) << toString(measured.status);
        EXPECT_LT(translationError(measured.T_odom_cog, truth), 0.01);
        EXPECT_LT(rotationErrorDeg(measured.T_odom_cog, truth), 0.05);
        EXPECT_EQ(measured.degenerate_directions, 0);
        EXPECT_GT(measured.inlier_ratio, 0.8);
        EXPECT_LT(measured.rms_residual_m, 0.03);
        expectUsable(measured);
      }
    }
  }
}

TEST(IcpPointToPlane, WorksFarFromTheOrigin) {
  const Pose T_far = poseOf(5000.0, -4000.0, 80.0, 1.0, -2.0, 130.0), T_step = poseOf(0.4, 0.1, 0.0, 0.0, 0.0, 1.5);
  const Points first = seenFrom(sampleScene(room(), 25.0, kNoise_m, 1), Pose::Identity());
  const Measurement m =
      IcpPointToPlane(testParams()).align(sweepOf(room(), T_step, 2), mapOf(first, T_far), T_far, 0.0);
  ASSERT_TRUE(m.ok());
  EXPECT_LT(translationError(m.T_odom_cog, T_far * T_step), 0.01);
  EXPECT_LT(rotationErrorDeg(m.T_odom_cog, T_far * T_step), 0.05);
}

// One Gauss-Newton step against numerically differentiated residuals of the correspondences at the start.
TEST(IcpPointToPlane, AStepIsThatOfFiniteDifferences) {
  IcpPointToPlane::Params params = testParams();
  params.filter_normals = false;
  params.support.below_ratio = 0.0;
  params.max_iterations = 1;
  params.relaxed_convergence_factor = 1e6;
  params.kernel_m = params.initial_kernel_m = 0.3;
  params.ground_weight = params.ground_information_weight = 1.0;
  params.observability.min_information_ratio = 0.0;
  params.usual_curvature_ratio = params.scan_line_sigma_m = 0.0;
  const VoxelMap map = mapOf(room(), 1);
  const Pose T0 = poseOf(0.1, -0.05, 0.03, 0.3, -0.2, 1.0);
  const Points points = sweepOf(room(), poseOf(0.2, 0.1, 0.0, 0.0, 0.0, 0.0), 2);
  const Measurement m = IcpPointToPlane(params).align(points, map, T0, 0.0);
  ASSERT_TRUE(m.ok());

  constexpr double kStep = 1e-5;
  Matrix6d H = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  std::size_t used = 0;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d q = point.cast<double>();
    VoxelMap::PlaneMatch match;
    VoxelMap::Neighborhood neighborhood;
    if (!map.findPlane(T0 * q, match, neighborhood) || std::abs(match.distance_m) > params.max_distance_m) continue;
    ++used;
    const Eigen::Vector3d n = match.plane->normal.cast<double>();
    const auto residual = [&](const Vector6d& dx) { return match.distance_m + n.dot(applyStep(T0, dx) * q - T0 * q); };
    Vector6d J;
    for (int i = 0; i < 6; ++i) {
      J[i] = (residual(kStep * Vector6d::Unit(i)) - residual(-kStep * Vector6d::Unit(i))) / (2.0 * kStep);
    }
    const double r = residual(Vector6d::Zero());
    const double kernel = 0.09 / (0.09 + r * r);
    const double weight = kernel * kernel / (0.03 * 0.03 + match.plane->variance);
    H += weight * J * J.transpose();
    b -= weight * r * J;
  }
  EXPECT_EQ(m.inliers, used);
  const Vector6d dx = solutionOf(H, b);
  EXPECT_GT(dx.norm(), 0.05);
  const Pose expected = applyStep(T0, dx);
  EXPECT_LT(translationError(m.T_odom_cog, expected), 1e-6);
  EXPECT_LT(rotationErrorDeg(m.T_odom_cog, expected), 1e-5);
  const Matrix6d information = inverseOf(H) * params.correlation_inflation;
  EXPECT_LT((m.covariance - dx * dx.transpose() - information).norm(), 1e-6 * information.norm());
}

TEST(IcpPointToPlane, WhatIsFarCountsMore) {
  // two walls across, 5 m and 20 m ahead, that want the vehicle 0.2 m apart; plus the rest of a room to hold it
  IcpPointToPlane::Params params = testParams();
  params.kernel_m = params.initial_kernel_m = 100.0;  // all alike
  Scene scene = {wall(5.0, -4.0, 5.0, 4.0, 4.0), wall(20.0, -4.0, 20.0, 4.0, 4.0), wall(0.0, -6.0, 24.0, -6.0, 4.0),
                 ground(0.0, -6.0, 24.0, 6.0)};
  const VoxelMap map = mapOf(scene, 1);
  scene[1] = wall(20.2, -4.0, 20.2, 4.0, 4.0);  // the vehicle sees the far one 0.2 m farther
  const Points points = sweepOf(scene, Pose::Identity(), 2);
  const auto forwardError = [&](double range_weight_m) {
    params.range_weight_m = range_weight_m;
    const Measurement m = IcpPointToPlane(params).align(points, map, Pose::Identity(), 0.0);
    EXPECT_TRUE(m.ok());
    return m.T_odom_cog.translation().x();
  };
  EXPECT_NEAR(forwardError(0.0), -0.1, 0.015);
  EXPECT_NEAR(forwardError(20.0), -0.16, 0.02);  // ranges about 1 : 4
  EXPECT_NEAR(forwardError(5.0), -0.16, 0.02);   // only the proportion counts
}

TEST(IcpPointToPlane, GroundCountsLess) {
  IcpPointToPlane::Params params = testParams();
  params.scan_line_sigma_m = 0.0;                     // the walls' lowest cells are half empty
  params.kernel_m = params.initial_kernel_m = 100.0;  // all alike
  const VoxelMap floor = mapOf(room(), 1);
  Points lowered = sweepOf(room(), Pose::Identity(), 2);  // ahead, the ground seems 0.1 m lower: a false pitch
  for (Eigen::Vector3f& p : lowered) {
    if (p.z() < -0.4f && p.x() > 0.0f) p.z() -= 0.1f;
  }
  params.ground_weight = 1.0;
  const double pitch_ground = std::abs(
      rpyFromRotation(IcpPointToPlane(params).align(lowered, floor, Pose::Identity(), 0.0).T_odom_cog.linear()).y());
  params.ground_weight = 0.02;
  const double pitch_walls = std::abs(
      rpyFromRotation(IcpPointToPlane(params).align(lowered, floor, Pose::Identity(), 0.0).T_odom_cog.linear()).y());
  EXPECT_GT(pitch_ground, 2.0 * pitch_walls);
}

/// What a lidar of few beams, 1.7 m above flat ground between four walls, sees from `forward_m`: a circle a beam, with
/// noise along the ray, and the walls.
Points circlesOnGround(double forward_m, unsigned seed) {
  constexpr double kHeight_m = 1.7;
  std::mt19937 generator(seed);
  std::normal_distribution<double> noise_m(0.0, 0.02);
  const Scene walls = {wall(25.0, -6.0, 25.0, 6.0, 8.0), wall(-25.0, -6.0, -25.0, 6.0, 8.0),
                       wall(-20.0, -25.0, 20.0, -25.0, 2.0), wall(-20.0, 25.0, 20.0, 25.0, 2.0)};
  Points points = seenFrom(sampleScene(walls, 25.0, kNoise_m, seed), poseOf(forward_m, 0.0, 0.0, 0.0, 0.0, 0.0));
  for (const double below_deg : {5.0, 7.0, 9.0, 11.0, 13.0}) {
    const double below = below_deg * kDegree;
    for (int i = 0; i < 720; ++i) {
      const double azimuth = 0.5 * i * kDegree, range_m = kHeight_m / std::sin(below) + noise_m(generator);
      points.emplace_back(range_m * std::cos(below) * std::cos(azimuth), range_m * std::cos(below) * std::sin(azimuth),
                          -range_m * std::sin(below));
    }
  }
  return points;
}

// Each circle makes patches that lean as its rays do. Whoever drives on over them would tip forward.
TEST(IcpPointToPlane, ScanLinesOnTheGroundHardlyTipTheVehicle) {
  constexpr double kForward_m = 0.3;
  const VoxelMap map = mapOf(circlesOnGround(0.0, 1), Pose::Identity());
  const Points later = circlesOnGround(kForward_m, 2);
  const Pose truth = poseOf(kForward_m, 0.0, 0.0, 0.0, 0.0, 0.0);
  const auto pitchErrorDeg = [&](double scan_line_sigma_m) {
    IcpPointToPlane::Params params = testParams();
    params.scan_line_sigma_m = scan_line_sigma_m;
    const Measurement m = IcpPointToPlane(params).align(later, map, truth, 0.0);
    EXPECT_TRUE(m.ok()) << toString(m.status);
    return std::abs(rpyFromRotation(m.T_odom_cog.linear()).y()) / kDegree;
  };
  const double tipped_deg = pitchErrorDeg(0.0);
  EXPECT_GT(tipped_deg, 0.1);
  EXPECT_LT(pitchErrorDeg(IcpPointToPlane::Params().scan_line_sigma_m), 0.3 * tipped_deg);
}

TEST(IcpPointToPlane, AMovedCarDoesNotMatter) {
  Scene with_car = room(), car_moved = room();
  addPost(with_car, 6.0, -2.0, 2.0, 2.0);
  addPost(car_moved, 6.4, -2.0, 2.0, 2.0);
  const Pose truth = poseOf(0.3, 0.1, 0.0, 0.0, 0.0, 1.0);
  const Measurement m =
      IcpPointToPlane(testParams()).align(sweepOf(car_moved, truth, 2), mapOf(with_car, 1), Pose::Identity(), 0.0);
  ASSERT_TRUE(m.ok());
  EXPECT_LT(translationError(m.T_odom_cog, truth), 0.02);
  EXPECT_LT(rotationErrorDeg(m.T_odom_cog, truth), 0.1);
}

/// How many points of one patch take part: its normal `n`, the vehicle's heading, the filter.
std::size_t inliersOnPatch(const Eigen::Vector3d& n, double heading_deg, double sigma_yaw_rad,
                           const IcpPointToPlane::Params& params) {
  const Eigen::Vector3d u = n.unitOrthogonal(), v = n.cross(u);
  const Scene patch = {{5.0 * n - 4.0 * u - 4.0 * v, 8.0 * u, 8.0 * v}};
  const Pose T = poseOf(0.0, 0.0, 0.0, 0.0, 0.0, heading_deg);
  const std::vector<Eigen::Vector3d> points = sampleScene(patch, 30.0, 0.0, 1);
  return IcpPointToPlane(params)
      .align(seenFrom(points, T), mapOf(seenFrom(points, Pose::Identity()), Pose::Identity()), T, sigma_yaw_rad)
      .inliers;
}

Eigen::Vector3d horizontal(double azimuth_deg) {
  return {std::cos(azimuth_deg * kDegree), std::sin(azimuth_deg * kDegree), 0.0};
}

TEST(IcpPointToPlane, KeepsNormalsAlongAndAcrossTheHeading) {
  IcpPointToPlane::Params params = testParams();
  params.heading_tolerance_deg = 10.0;
  for (const double heading : {0.0, 25.0, -160.0}) {
    for (const int quarter : {0, 1, 2, 3}) {
      const double axis = heading + 90.0 * quarter;
      for (const double off : {-44.0, -10.5, -9.5, -5.0, 0.0, 5.0, 9.5, 10.5, 20.0, 44.0}) {
        const std::size_t inliers = inliersOnPatch(horizontal(axis + off), heading, 0.0, params);
        if (std::abs(off) < 10.0) {
          EXPECT_GT(inliers, 1000u) << heading << " " << axis << " " << off;
        } else {
          EXPECT_EQ(inliers, 0u) << heading << " " << axis << " " << off;
        }
      }
    }
  }
}

TEST(IcpPointToPlane, AnUncertainHeadingWidensTheFilter) {
  IcpPointToPlane::Params params = testParams();
  params.heading_tolerance_deg = 10.0;
  EXPECT_EQ(inliersOnPatch(horizontal(20.0), 0.0, 15.0 * kDegree, params), 0u);
  EXPECT_GT(inliersOnPatch(horizontal(20.0), 0.0, 25.0 * kDegree, params), 1000u);
  EXPECT_GT(inliersOnPatch(horizontal(5.0), 0.0, 0.1 * kDegree, params), 1000u);  // the floor of the tolerance
  EXPECT_GT(inliersOnPatch(horizontal(44.9), 0.0, 3.0, params), 1000u);           // beyond 45 deg: everything
  params.heading_tolerance_deg = 45.0;
  for (double azimuth = 0.0; azimuth < 360.0; azimuth += 15.0) {
    EXPECT_GT(inliersOnPatch(horizontal(azimuth), 0.0, 0.0, params), 1000u) << azimuth;
  }
}

TEST(IcpPointToPlane, TellsGroundFromWallsAndSlopes) {
  IcpPointToPlane::Params params = testParams();
  const auto tilted = [](double from_vertical_deg) {
    return Eigen::Vector3d(std::sin(from_vertical_deg * kDegree), 0.0, std::cos(from_vertical_deg * kDegree));
  };
  for (const bool keep_ground : {true, false}) {
    params.keep_ground = keep_ground;
    EXPECT_EQ(inliersOnPatch(tilted(0.0), 0.0, 0.0, params) > 1000u, keep_ground);
    EXPECT_EQ(inliersOnPatch(tilted(28.0), 0.0, 0.0, params) > 1000u, keep_ground);
    EXPECT_EQ(inliersOnPatch(tilted(32.0), 0.0, 0.0, params), 0u);
    EXPECT_EQ(inliersOnPatch(tilted(58.0), 0.0, 0.0, params), 0u);
    EXPECT_GT(inliersOnPatch(tilted(62.0), 0.0, 0.0, params), 1000u);
    EXPECT_GT(inliersOnPatch(tilted(90.0), 0.0, 0.0, params), 1000u);
  }
  params.filter_normals = false;
  EXPECT_GT(inliersOnPatch(tilted(45.0), 0.0, 0.0, params), 1000u);
  EXPECT_GT(inliersOnPatch(horizontal(30.0), 0.0, 0.0, params), 1000u);
}

TEST(IcpPointToPlane, OnlyTheGroundTellsTheHeight) {
  const VoxelMap map = mapOf(room(), 1);
  const Pose truth = poseOf(0.2, 0.1, 0.0, 0.0, 0.0, 0.5), start = poseOf(0.0, 0.0, 0.15, 0.0, 0.0, 0.0);
  const Points points = sweepOf(room(), truth, 2);
  IcpPointToPlane::Params params = testParams();
  const Measurement with_ground = IcpPointToPlane(params).align(points, map, start, 0.0);
  ASSERT_TRUE(with_ground.ok());
  EXPECT_NEAR(with_ground.T_odom_cog.translation().z(), 0.0, 0.005);
  EXPECT_EQ(with_ground.degenerate_directions, 0);
  EXPECT_LT(std::sqrt(with_ground.covariance(2, 2)), 0.05);

  params.keep_ground = false;
  const Measurement walls_only = IcpPointToPlane(params).align(points, map, start, 0.0);
  ASSERT_TRUE(walls_only.ok());
  EXPECT_NEAR(walls_only.T_odom_cog.translation().z(), 0.15, 0.02);
  EXPECT_GE(walls_only.degenerate_directions, 1);
  EXPECT_NEAR(std::sqrt(walls_only.covariance(2, 2)), params.observability.weak_sigma_m, 0.1);
  EXPECT_NEAR(walls_only.T_odom_cog.translation().x(), 0.2, 0.01);
  EXPECT_NEAR(walls_only.T_odom_cog.translation().y(), 0.1, 0.01);
  EXPECT_LT(std::sqrt(walls_only.covariance(0, 0)), 0.1 * params.observability.weak_sigma_m);
}

// The planes of rough walls are tilted by chance, some forwards, some backwards: they seem to observe the way along.
TEST(IcpPointToPlane, WhatRoughWallsSayByChanceDoesNotCount) {
  constexpr double kRough_m = 0.06;
  IcpPointToPlane::Params params = testParams();
  params.correlation_inflation = 20.0;  // of the figures below
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Points reference = seenFrom(sampleScene(corridor(), 6.0, kRough_m, seed), Pose::Identity());
    const Points points =
        seenFrom(sampleScene(corridor(), 4.0, kRough_m, seed + 10), poseOf(1.0, 0.1, 0.0, 0.0, 0.0, 0.0), 25.0);
    const Measurement m = IcpPointToPlane(params).align(points, mapOf(reference, Pose::Identity()),
                                                        poseOf(0.4, 0.0, 0.0, 0.0, 0.0, 0.0), 0.0);
    ASSERT_TRUE(m.ok());
    EXPECT_GT(m.min_information_ratio, params.observability.min_information_ratio) << "too smooth for this test";
    EXPECT_GT(std::sqrt(m.covariance(0, 0)), 0.19) << "0.14 to 0.16 m if all that the normals say counted";
    EXPECT_NEAR(m.T_odom_cog.translation().y(), 0.1, 0.02);
  }
}

TEST(IcpPointToPlane, AlongACorridorItStaysAtThePrediction) {
  const IcpPointToPlane icp(testParams());
  for (const double heading_deg : {0.0, 35.0}) {
    const Pose T_odom_corridor = poseOf(0.0, 0.0, 0.0, 0.0, 0.0, heading_deg);
    const Points reference = seenFrom(sampleScene(corridor(), 15.0, kNoise_m, 1), Pose::Identity());
    const Points points =
        seenFrom(sampleScene(corridor(), 4.0, kNoise_m, 2), poseOf(1.0, 0.2, 0.0, 0.0, 0.0, 1.0), 25.0);
    const Pose start = T_odom_corridor * poseOf(0.4, 0.0, 0.1, 0.0, 0.0, 0.0);
    const Measurement m = icp.align(points, mapOf(reference, T_odom_corridor), start, 0.0);
    ASSERT_TRUE(m.ok());
    EXPECT_EQ(m.degenerate_directions, 1);
    EXPECT_LT(m.min_information_ratio, 0.01);
    const Pose T_corridor_cog = T_odom_corridor.inverse() * m.T_odom_cog;
    EXPECT_NEAR(T_corridor_cog.translation().x(), 0.4, 0.005);
    EXPECT_NEAR(T_corridor_cog.translation().y(), 0.2, 0.01);
    EXPECT_NEAR(T_corridor_cog.translation().z(), 0.0, 0.01);
    EXPECT_NEAR(rpyFromRotation(T_corridor_cog.linear()).z(), 1.0 * kDegree, 0.05 * kDegree);
    const Matrix6d C = rotateCovariance(m.covariance, T_odom_corridor.linear().transpose());
    EXPECT_NEAR(std::sqrt(C(0, 0)), icp.params().observability.weak_sigma_m, 0.05);
    EXPECT_LT(std::sqrt(C(1, 1)), 0.05);
    EXPECT_LT(std::sqrt(C(5, 5)), 0.5 * kDegree);
    expectUsable(m);
  }
}

TEST(IcpPointToPlane, ARoomHasInformationInEveryDirection) {
  const Measurement m = IcpPointToPlane(testParams())
                            .align(sweepOf(room(), Pose::Identity(), 2), mapOf(room(), 1), Pose::Identity(), 0.0);
  EXPECT_GT(m.min_information_ratio, 0.15);
}

TEST(IcpPointToPlane, ItsErrorsAreNotBeyondItsCovariance) {
  const IcpPointToPlane icp(testParams());
  const VoxelMap map = mapOf(room(), 1);
  for (unsigned seed = 10; seed < 20; ++seed) {
    const Pose truth = poseOf(0.02 * seed, 0.1, 0.0, 0.0, 0.0, 0.5);
    const Measurement m = icp.align(sweepOf(room(), truth, seed), map, Pose::Identity(), 0.0);
    ASSERT_TRUE(m.ok());
    const Eigen::Vector3d error = m.T_odom_cog.translation() - truth.translation();
    for (int i = 0; i < 3; ++i) EXPECT_LT(std::abs(error[i]), 3.0 * std::sqrt(m.covariance(i, i))) << seed;
    EXPECT_LT(std::sqrt(m.covariance(0, 0)), 0.05);
  }
}

TEST(IcpPointToPlane, PointsThatAreScatteredBeyondTheKernelTellLittle) {
  const IcpPointToPlane icp(testParams());
  const VoxelMap map = mapOf(room(), 1);
  std::mt19937 random(7);
  std::normal_distribution<float> scatter_m(0.0f, 0.5f);
  double squared = 0.0;
  constexpr int kSweeps = 20;
  for (unsigned seed = 10; seed < 10 + kSweeps; ++seed) {
    Points sweep = sweepOf(room(), Pose::Identity(), seed);
    const double sure_m = std::sqrt(icp.align(sweep, map, Pose::Identity(), 0.0).covariance(0, 0));
    for (Eigen::Vector3f& p : sweep) p += Eigen::Vector3f(scatter_m(random), scatter_m(random), scatter_m(random));
    const Measurement m = icp.align(sweep, map, poseOf(0.1, 0.0, 0.0, 0.0, 0.0, 0.0), 0.0);
    EXPECT_GT(std::sqrt(m.covariance(0, 0)), 2.0 * sure_m) << seed;
    squared += m.T_odom_cog.translation().x() * m.T_odom_cog.translation().x() / m.covariance(0, 0);
  }
  EXPECT_LT(squared / kSweeps, 2.0);
}

TEST(IcpPointToPlane, WithoutAReferenceItSaysSo) {
  const Pose start = poseOf(1.0, 2.0, 3.0, 0.0, 0.0, 40.0);
  const Measurement m = IcpPointToPlane(testParams()).align(sweepOf(room(), start, 1), VoxelMap(), start, 0.0);
  EXPECT_EQ(m.status, MeasurementStatus::kNoReference);
  EXPECT_EQ(m.T_odom_cog.matrix(), start.matrix());
}

TEST(IcpPointToPlane, TooFewPointsKeepThePrediction) {
  const IcpPointToPlane icp(testParams());
  const VoxelMap map = mapOf(room(), 1);
  const Pose start = poseOf(0.1, 0.0, 0.0, 0.0, 0.0, 3.0), far = poseOf(500.0, 0.0, 0.0, 0.0, 0.0, 0.0);
  const Points points = sweepOf(room(), start, 2);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const auto& [cloud, pose] :
       {std::make_pair(Points(), start), std::make_pair(Points(points.begin(), points.begin() + 99), start),
        std::make_pair(points, far), std::make_pair(Points(1000, {nan, nan, nan}), start)}) {
    const Measurement m = icp.align(cloud, map, pose, 0.0);
    EXPECT_EQ(m.status, MeasurementStatus::kTooFewPoints);
    EXPECT_EQ(m.T_odom_cog.matrix(), pose.matrix());
    expectUsable(m);
  }
}

TEST(IcpPointToPlane, PointsThatAreNotFiniteAreLeftOut) {
  const IcpPointToPlane icp(testParams());
  const VoxelMap map = mapOf(room(), 1);
  const Pose truth = poseOf(0.2, 0.0, 0.0, 0.0, 0.0, 0.0);
  Points points = sweepOf(room(), truth, 2);
  const Measurement clean = icp.align(points, map, Pose::Identity(), 0.0);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (int i = 0; i < 200; ++i) points.emplace_back(nan, 1.0f, std::numeric_limits<float>::infinity());
  const Measurement m = icp.align(points, map, Pose::Identity(), 0.0);
  ASSERT_TRUE(m.ok());
  EXPECT_EQ(m.T_odom_cog.matrix(), clean.T_odom_cog.matrix());
  EXPECT_EQ(m.inliers, clean.inliers);
}

TEST(IcpPointToPlane, IterationLimitCostsCovariance) {
  IcpPointToPlane::Params params = testParams();
  const VoxelMap map = mapOf(room(), 1);
  const Points points = sweepOf(room(), poseOf(0.4, 0.2, 0.0, 0.0, 0.0, 1.0), 2);
  const Measurement converged = IcpPointToPlane(params).align(points, map, Pose::Identity(), 0.0);
  ASSERT_TRUE(converged.ok());
  EXPECT_LT(converged.iterations, 30);
  params.max_iterations = 1;
  params.relaxed_convergence_factor = 1.0;
  const Measurement stopped = IcpPointToPlane(params).align(points, map, Pose::Identity(), 0.0);
  EXPECT_EQ(stopped.status, MeasurementStatus::kNotConverged);
  EXPECT_EQ(stopped.iterations, 1);
  expectUsable(stopped);
  params.relaxed_convergence_factor = 1e6;
  const Measurement accepted = IcpPointToPlane(params).align(points, map, Pose::Identity(), 0.0);
  EXPECT_TRUE(accepted.ok());
  EXPECT_GT(std::sqrt(accepted.covariance(0, 0)), 0.2);
}

TEST(IcpPointToPlane, IsDeterministic) {
  const IcpPointToPlane icp(testParams());
  const VoxelMap map = mapOf(street(), 1);
  const Points points = sweepOf(street(), poseOf(0.4, 0.2, 0.0, 0.0, 0.0, 1.0), 2);
  const Measurement a = icp.align(points, map, Pose::Identity(), 0.0),
                    b = icp.align(points, map, Pose::Identity(), 0.0);
  EXPECT_EQ(a.T_odom_cog.matrix(), b.T_odom_cog.matrix());
  EXPECT_EQ(a.covariance, b.covariance);
}

TEST(IcpPointToPlane, ValidatesItsParameters) {
  const auto rejects = [](auto change) {
    IcpPointToPlane::Params params = testParams();
    change(params);
    EXPECT_THROW(validate(params), ParameterError);
  };
  EXPECT_NO_THROW(validate(IcpPointToPlane::Params()));
  rejects([](auto& p) { p.heading_tolerance_deg = 46.0; });
  rejects([](auto& p) { p.kernel_m = 0.0; });
  rejects([](auto& p) { p.max_iterations = 0; });
}

}  // namespace
}  // namespace fail_aware::icp_point_to_plane_test
