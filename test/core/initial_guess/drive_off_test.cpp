#include "core/initial_guess/drive_off.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace fail_aware::drive_off_test {
namespace {

constexpr double kPeriod_s = 0.1;

/// Poles, seen from a vehicle that has moved by moved_m along x, 0.4 to 3 m above the ground.
std::vector<Eigen::Vector3f> poles(double moved_m) {
  std::vector<Eigen::Vector3f> points;
  for (const double side_m : {-8.0, 8.0}) {
    for (int i = 0; i < 12; ++i) {
      const double x_m = -30.0 + 3.7 * i + 0.14 * i * i + (side_m > 0.0 ? 1.9 : 0.0);
      for (double z_m = -1.7; z_m < 1.5; z_m += 0.1) {
        points.push_back(Eigen::Vector3d(x_m - moved_m, side_m, z_m).cast<float>());
      }
    }
  }
  return points;
}

/// Walls on both sides that look alike everywhere.
std::vector<Eigen::Vector3f> walls() {
  std::vector<Eigen::Vector3f> points;
  for (const double side_m : {-4.0, 4.0}) {
    for (double x_m = -30.0; x_m < 30.0; x_m += 0.1) {
      for (double z_m = -1.7; z_m < 1.5; z_m += 0.2) {
        points.push_back(Eigen::Vector3d(x_m, side_m, z_m).cast<float>());
      }
    }
  }
  return points;
}

std::optional<double> found(const std::vector<Eigen::Vector3f>& first, const std::vector<Eigen::Vector3f>& now,
                            double standing_ratio = 0.9) {
  VoxelMap::Params params;
  params.voxel_size_m = 0.4;
  params.max_points = VoxelMap::kMaxPoints;
  params.min_point_spacing_m = 0.05;
  VoxelMap map(params);
  map.insert(first, Pose::Identity());
  const AboveGroundPoints above_ground = findAboveGroundPoints(now, {3.0, 0.5, 0.4}, 4000);
  const OcclusionImage nothing_hidden;
  return findDrivenOff(FirstSweepMatcher(above_ground, map, nothing_hidden), DistanceKernels(), 0.0, standing_ratio);
}

TEST(DriveOff, FindsTheDistance) {
  for (const double moved_m : {-0.6, 0.3, 1.0, 2.35, 7.4}) {
    const std::optional<double> distance_m = found(poles(0.0), poles(moved_m));
    ASSERT_TRUE(distance_m) << moved_m;
    EXPECT_NEAR(*distance_m, moved_m, 0.06);
  }
}

TEST(DriveOff, NothingIsFoundAtTheEdgeOfTheSearch) { EXPECT_FALSE(found(poles(0.0), poles(8.3))); }

TEST(DriveOff, AStandstillIsNoDistance) {
  const std::optional<double> distance_m = found(poles(0.0), poles(0.02));
  ASSERT_TRUE(distance_m);
  EXPECT_EQ(*distance_m, 0.0);
}

TEST(DriveOff, NothingStandsOutAlongSmoothWalls) {
  constexpr double kNeverStands = 1.1;
  EXPECT_FALSE(found(walls(), walls(), kNeverStands));
  EXPECT_TRUE(found(poles(0.0), poles(1.0), kNeverStands));
}

TEST(DriveOff, NothingIsFoundWithoutAPoint) { EXPECT_FALSE(found(poles(0.0), {})); }

/// Feeds sweeps from the first known one on; each has a distance or none.
struct Feed {
  double period_s = kPeriod_s;
  DriveOff drive_off{};
  int sweep = 0;

  std::optional<DriveOff::Place> add(std::optional<double> distance_m, double predicted_m) {
    ++sweep;
    return drive_off.add({sweep * period_s, period_s, predicted_m}, [&](double) { return distance_m; });
  }
  /// The prediction is right.
  std::optional<DriveOff::Place> add(std::optional<double> distance_m) {
    return add(distance_m, distance_m.value_or(0.0));
  }

  void stand(int sweeps) {
    for (int i = 0; i < sweeps; ++i) add(0.0);
  }
};

TEST(DriveOff, BeginsAtAStandstillThatTimeConfirms) {
  Feed feed;
  EXPECT_FALSE(feed.add(0.0)) << "0.1 s are too short";
  ASSERT_TRUE(feed.add(0.0));
  EXPECT_TRUE(feed.drive_off.stands());
  Feed moving;
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(moving.add(i < 3 ? 0.5 : 0.0)) << i;
  Feed fast;
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(fast.add(0.0, 2.0)) << "the search for the first motion found a speed";
  Feed slow_head{0.2};
  EXPECT_FALSE(slow_head.add(std::nullopt)) << "of the second sweep the motion is not known";
  EXPECT_TRUE(slow_head.add(0.0)) << "at 5 Hz";
}

TEST(DriveOff, FollowsUntilTheStartIsLeft) {
  Feed feed;
  feed.stand(5);
  for (double distance_m = 0.3; distance_m < 6.9; distance_m += 0.2) {
    const auto place = feed.add(distance_m);
    ASSERT_TRUE(place && place->distance_m);
    EXPECT_EQ(*place->distance_m, distance_m);
    EXPECT_LE(place->sigma_m, 0.05);
  }
  EXPECT_FALSE(feed.add(7.2));
  EXPECT_FALSE(feed.drive_off.isFollowing());
}

TEST(DriveOff, DoubtGrowsWhileNoDistanceIsFound) {
  Feed feed;
  feed.stand(5);
  double last_m = 0.0;
  for (int i = 1; i <= 8; ++i) {
    const auto place = feed.add(std::nullopt);
    ASSERT_TRUE(place && !place->distance_m);
    EXPECT_GE(place->sigma_m, 0.5 * 3.0 * std::pow(i * kPeriod_s, 2)) << "a vehicle that drives off at 3 m/s2";
    EXPECT_GT(place->sigma_m, last_m);
    EXPECT_FALSE(feed.drive_off.stands());
    last_m = place->sigma_m;
  }
  EXPECT_TRUE(feed.add(0.6, 0.0)->distance_m) << "found again";
}

/// Registration has stayed with the vehicles that travel along. The scenery shows the true distance.
TEST(DriveOff, ADistanceFarFromThePredictionIsBelieved) {
  Feed feed;
  feed.stand(5);
  EXPECT_EQ(feed.add(1.4, 0.0)->distance_m, 1.4);
}

TEST(DriveOff, IsLostWhereNoDistanceIsFoundForLong) {
  Feed feed;
  feed.stand(5);
  for (int i = 0; i < 8; ++i) feed.add(std::nullopt);
  EXPECT_TRUE(feed.drive_off.isFollowing());
  feed.add(std::nullopt);
  EXPECT_FALSE(feed.drive_off.isFollowing());
  const auto place = feed.add(0.6);
  ASSERT_TRUE(place);
  EXPECT_FALSE(place->distance_m) << "no longer believed";
  EXPECT_GT(place->sigma_m, 1.0);
  EXPECT_FALSE(feed.add(0.0)->distance_m) << "nor that it stands";
  feed.drive_off.clear();
  EXPECT_FALSE(feed.add(0.0)) << "the drive began too long ago";
}

TEST(DriveOff, IsLostIfTheVehicleSeemsToComeBack) {
  Feed feed;
  feed.stand(5);
  feed.add(0.3);
  feed.add(0.5);
  ASSERT_TRUE(feed.add(0.4)->distance_m) << "scatter";
  EXPECT_FALSE(feed.add(0.3)->distance_m);
  EXPECT_FALSE(feed.drive_off.isFollowing());
  EXPECT_FALSE(feed.add(0.0)->distance_m) << "it had driven off";
}

}  // namespace
}  // namespace fail_aware::drive_off_test
