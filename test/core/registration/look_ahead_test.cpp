#include "core/registration/look_ahead.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/geometry/rotation.hpp"

namespace fail_aware::look_ahead_test {
namespace {

using Points = std::vector<Eigen::Vector3f>;

constexpr double kEnd_m = 100.0;

// Two walls along the road, 5 m from its middle and 4 m high, made of points 0.4 m apart with 1 cm of noise. Up to
// `smooth_from_m`, and again from `smooth_to_m` on, a pier stands out across the road every 12 m.
Points road(double smooth_from_m, double smooth_to_m, double curvature_per_m = 0.0) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, 0.01);
  Points points;
  const auto add = [&](double along_m, double left_m, double z_m) {
    const double heading = curvature_per_m * along_m, chord = 0.5 * heading;
    const Eigen::Vector2d middle = along_m * Eigen::Vector2d(std::cos(chord), std::sin(chord));
    const Eigen::Vector2d place = middle + left_m * Eigen::Vector2d(-std::sin(heading), std::cos(heading));
    points.emplace_back(Eigen::Vector3d(place.x() + noise(random), place.y() + noise(random), z_m).cast<float>());
  };
  for (const double side : {-5.0, 5.0}) {
    for (double along_m = -20.0; along_m < kEnd_m; along_m += 0.4) {
      for (double z_m = 0.2; z_m < 4.0; z_m += 0.4) add(along_m, side, z_m);
    }
    for (double along_m = -18.0; along_m < kEnd_m; along_m += 12.0) {
      if (along_m > smooth_from_m && along_m < smooth_to_m) continue;
      for (double out_m = 0.0; out_m < 1.6; out_m += 0.2) {
        for (double z_m = 0.2; z_m < 4.0; z_m += 0.4) add(along_m, std::copysign(5.0 - out_m, side), z_m);
      }
    }
  }
  return points;
}

Vector6d driving(double speed_mps, double yaw_rate_rps = 0.0) {
  Vector6d twist = Vector6d::Zero();
  twist[0] = speed_mps;
  twist[5] = yaw_rate_rps;
  return twist;
}

InformationAhead seenOn(const Points& points, const Pose& T_odom_cog, const Vector6d& twist_cog) {
  VoxelMap map;
  for (int i = 0; i < 3; ++i) map.insert(points, Pose::Identity());
  Points about_vehicle;
  const Pose T_cog_odom = T_odom_cog.inverse();
  for (const Eigen::Vector3f& point : points)
    about_vehicle.push_back((T_cog_odom * point.cast<double>()).cast<float>());
  return lookAhead(IcpPointToPlane::Params(), about_vehicle, map, T_odom_cog, twist_cog);
}

InformationAhead seenOn(const Points& points) { return seenOn(points, Pose::Identity(), driving(15.0)); }

TEST(LookAhead, RoadWithPiersIsNowhereWeak) {
  const InformationAhead ahead = seenOn(road(kEnd_m, kEnd_m));
  ASSERT_TRUE(ahead.known());
  EXPECT_GT(ahead.ratio, 0.02);
}

TEST(LookAhead, SmoothWallsAreSeenWhereTheyBegin) {
  const InformationAhead ahead = seenOn(road(35.0, kEnd_m));
  EXPECT_LT(ahead.ratio, 0.002);
  EXPECT_GE(ahead.distance_m, 50.0) << "no pier within 25 m";
  EXPECT_LE(ahead.distance_m, 70.0);
}

TEST(LookAhead, AShortGapIsNoWeakStretch) {
  EXPECT_GT(seenOn(road(20.0, 70.0)).ratio, 0.01) << "50 m without a pier: hardly two poses without one in 25 m";
  EXPECT_LT(seenOn(road(0.0, 80.0)).ratio, 0.002);
}

TEST(LookAhead, PathAndPoseAreFollowed) {
  const double curvature_per_m = 0.01;
  const Points bend = road(35.0, kEnd_m, curvature_per_m);
  // the wall of a bend tells of the way along it, so the ratio is not that of a straight tunnel
  const InformationAhead along = seenOn(bend, Pose::Identity(), driving(15.0, 15.0 * curvature_per_m));
  EXPECT_TRUE(along.known());
  EXPECT_GT(along.ratio, seenOn(road(35.0, kEnd_m)).ratio);
  Pose beside = Pose::Identity();
  beside.linear() = rotationFromRpy(0.0, 0.0, M_PI / 2);
  EXPECT_FALSE(seenOn(road(35.0, kEnd_m), beside, driving(15.0)).known()) << "nothing stands where the path leads";
}

TEST(LookAhead, InReverseItLooksBack) {
  EXPECT_FALSE(seenOn(road(35.0, kEnd_m), Pose::Identity(), driving(-15.0)).ratio < 0.002) << "the piers behind";
}

TEST(LookAhead, NothingInViewIsNotKnown) {
  EXPECT_FALSE(seenOn({}).known());
  EXPECT_FALSE(
      lookAhead(IcpPointToPlane::Params(), road(0.0, kEnd_m), VoxelMap(), Pose::Identity(), driving(10.0)).known());
  Vector6d not_finite = driving(10.0);
  not_finite[5] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(seenOn(road(0.0, kEnd_m), Pose::Identity(), not_finite).known());
}

}  // namespace
}  // namespace fail_aware::look_ahead_test
