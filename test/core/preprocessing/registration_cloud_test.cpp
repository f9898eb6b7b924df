#include "core/preprocessing/registration_cloud.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "../../support/synthetic_scene.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::registration_cloud_test {
namespace {

using Points = std::vector<Eigen::Vector3f>;

RegistrationCloudBuilder::Params testParams() {
  RegistrationCloudBuilder::Params params;
  params.min_range_m = 3.0;
  params.max_range_m = 20.0;
  params.map_voxel_m = 0.3;
  params.plane_voxel_m = 1.0;
  params.point_voxel_m = 1.5;
  return params;
}

/// A room's sweep whose times tell each point: its number in microseconds.
CorrectedSweep numberedSweep(unsigned seed = 1) {
  CorrectedSweep sweep;
  sweep.stamp_s = 12.5;
  sweep.points_lidar = seenFrom(sampleScene(room(), 20.0, 0.01, seed), poseOf(0.0, 0.0, 1.0, 0.0, 0.0, 0.0));
  for (std::size_t i = 0; i < sweep.points_lidar.size(); ++i) sweep.times_s.push_back(1e-6f * static_cast<float>(i));
  return sweep;
}

std::size_t numberOf(float time_s) { return static_cast<std::size_t>(std::lround(1e6 * static_cast<double>(time_s))); }

/// Every point is the sweep's of that time, moved into the vehicle's frame.
void expectFromSweep(const Points& points_cog, const std::vector<float>& times_s, const CorrectedSweep& sweep,
                     const Pose& T_cog_lidar) {
  ASSERT_EQ(points_cog.size(), times_s.size());
  for (std::size_t i = 0; i < points_cog.size(); ++i) {
    const Eigen::Vector3d expected = T_cog_lidar * sweep.points_lidar[numberOf(times_s[i])].cast<double>();
    ASSERT_LT((points_cog[i].cast<double>() - expected).norm(), 1e-5);
  }
}

/// In the sweep's order.
void expectWithin(const std::vector<float>& times_s, std::vector<float> all_times_s) {
  EXPECT_TRUE(std::is_sorted(times_s.begin(), times_s.end()));
  std::sort(all_times_s.begin(), all_times_s.end());
  EXPECT_TRUE(std::includes(all_times_s.begin(), all_times_s.end(), times_s.begin(), times_s.end()));
}

TEST(RegistrationCloud, ThinsIntoTheVehiclesFrame) {
  const Pose T_cog_lidar = poseOf(0.7, -0.2, 1.2, 1.0, -2.0, 30.0);
  const CorrectedSweep sweep = numberedSweep();
  RegistrationCloud cloud;
  RegistrationCloudBuilder(testParams()).build(sweep, T_cog_lidar, cloud);
  EXPECT_EQ(cloud.stamp_s, 12.5);
  EXPECT_GT(cloud.map_points_cog.size(), 2 * cloud.plane_points_cog.size());
  EXPECT_GT(cloud.plane_points_cog.size(), cloud.point_points_cog.size());
  EXPECT_GT(cloud.point_points_cog.size(), 100u);
  expectFromSweep(cloud.map_points_cog, cloud.map_times_s, sweep, T_cog_lidar);
  expectFromSweep(cloud.plane_points_cog, cloud.plane_times_s, sweep, T_cog_lidar);
  expectFromSweep(cloud.point_points_cog, cloud.point_times_s, sweep, T_cog_lidar);
  expectWithin(cloud.plane_times_s, cloud.map_times_s);
  expectWithin(cloud.point_times_s, cloud.map_times_s);
}

TEST(RegistrationCloud, RangesAreMeasuredFromTheLidar) {
  CorrectedSweep sweep;
  for (const float x : {-25.0f, -19.9f, -3.1f, -2.9f, 2.9f, 3.1f, 19.9f, 20.1f}) {
    sweep.points_lidar.emplace_back(x, 0.0f, 0.0f);
  }
  Pose T_cog_lidar = Pose::Identity();
  T_cog_lidar.translation().x() = 10.0;
  RegistrationCloud cloud;
  RegistrationCloudBuilder(testParams()).build(sweep, T_cog_lidar, cloud);
  ASSERT_EQ(cloud.map_points_cog.size(), 4u);
  EXPECT_NEAR(cloud.map_points_cog.front().x(), -9.9f, 1e-5f);
  EXPECT_NEAR(cloud.map_points_cog.back().x(), 29.9f, 1e-5f);
}

TEST(RegistrationCloud, AReusedCloudHoldsNothingOfTheLastSweep) {
  RegistrationCloudBuilder builder(testParams());
  RegistrationCloud reused, fresh;
  builder.build(numberedSweep(2), poseOf(0.0, 0.0, 1.0, 0.0, 0.0, 0.0), reused);
  CorrectedSweep sweep = numberedSweep(3);
  sweep.points_lidar.resize(5000);
  sweep.times_s.clear();
  builder.build(sweep, Pose::Identity(), reused);
  RegistrationCloudBuilder(testParams()).build(sweep, Pose::Identity(), fresh);
  EXPECT_EQ(reused.map_points_cog, fresh.map_points_cog);
  EXPECT_EQ(reused.plane_points_cog, fresh.plane_points_cog);
  EXPECT_EQ(reused.point_points_cog, fresh.point_points_cog);
  EXPECT_TRUE(reused.map_times_s.empty());
  EXPECT_TRUE(reused.plane_times_s.empty());
  EXPECT_TRUE(reused.point_times_s.empty());
}

TEST(RegistrationCloud, LeavesOutWhatIsNotFinite) {
  CorrectedSweep sweep = numberedSweep();
  const std::size_t good = sweep.points_lidar.size();
  for (int i = 0; i < 10; ++i) {
    sweep.points_lidar.emplace_back(std::numeric_limits<float>::quiet_NaN(), 5.0f, 0.0f);
    sweep.times_s.push_back(0.1f);
  }
  RegistrationCloud cloud;
  RegistrationCloudBuilder(testParams()).build(sweep, Pose::Identity(), cloud);
  for (const float time : cloud.map_times_s) EXPECT_LT(numberOf(time), good);
  for (const Eigen::Vector3f& p : cloud.map_points_cog) ASSERT_TRUE(p.allFinite());
}

TEST(RegistrationCloud, AnEmptySweepGivesAnEmptyCloud) {
  RegistrationCloud cloud;
  RegistrationCloudBuilder(testParams()).build(CorrectedSweep(), Pose::Identity(), cloud);
  EXPECT_TRUE(cloud.map_points_cog.empty());
  EXPECT_TRUE(cloud.plane_points_cog.empty());
  EXPECT_TRUE(cloud.point_points_cog.empty());
}

TEST(RegistrationCloud, RecorrectMovesEveryPointByItsTime) {
  const Pose T_cog_lidar = poseOf(0.7, 0.0, 1.2, 0.0, 0.0, 0.0);
  CorrectedSweep sweep = numberedSweep();
  for (std::size_t i = 0; i < sweep.times_s.size(); ++i) {
    sweep.times_s[i] = -0.05f + 0.1f * static_cast<float>(i) / static_cast<float>(sweep.times_s.size());
  }
  RegistrationCloud before;
  RegistrationCloudBuilder(testParams()).build(sweep, T_cog_lidar, before);
  RegistrationCloud after = before;
  Vector6d twist_cog;
  twist_cog << 12.0, 0.1, 0.0, 0.01, -0.02, 0.3;
  after.redeskewBy(twist_cog);
  const auto expectMoved = [&](const Points& from, const Points& to, const std::vector<float>& times_s) {
    ASSERT_EQ(from.size(), to.size());
    double farthest = 0.0;
    for (std::size_t i = 0; i < from.size(); ++i) {
      const Eigen::Vector3d expected = expSe3(static_cast<double>(times_s[i]) * twist_cog) * from[i].cast<double>();
      ASSERT_LT((to[i].cast<double>() - expected).norm(), 2e-4);
      farthest = std::max(farthest, static_cast<double>((to[i] - from[i]).norm()));
    }
    EXPECT_GT(farthest, 0.4);
  };
  expectMoved(before.map_points_cog, after.map_points_cog, before.map_times_s);
  expectMoved(before.plane_points_cog, after.plane_points_cog, before.plane_times_s);
  expectMoved(before.point_points_cog, after.point_points_cog, before.point_times_s);
  EXPECT_EQ(before.map_times_s, after.map_times_s);
}

TEST(RegistrationCloud, RecorrectLeavesTheMiddleWhereItIs) {
  CorrectedSweep sweep = numberedSweep();
  for (std::size_t i = 0; i < sweep.times_s.size(); ++i) {
    sweep.times_s[i] = -0.1f + 0.1f * static_cast<float>(i) / static_cast<float>(sweep.times_s.size());
  }
  RegistrationCloud before;
  RegistrationCloudBuilder(testParams()).build(sweep, Pose::Identity(), before);
  EXPECT_NEAR(before.middle_s, -0.05, 1e-3);
  RegistrationCloud after = before;
  Vector6d twist_cog = Vector6d::Zero();
  twist_cog[0] = 12.0;
  after.redeskewBy(twist_cog, -0.05);
  ASSERT_EQ(before.map_points_cog.size(), after.map_points_cog.size());
  for (std::size_t i = 0; i < before.map_points_cog.size(); ++i) {
    const double moved_m = static_cast<double>(after.map_points_cog[i].x() - before.map_points_cog[i].x());
    EXPECT_NEAR(moved_m, 12.0 * (static_cast<double>(before.map_times_s[i]) + 0.05), 2e-4);
  }
  EXPECT_EQ(RegistrationCloud().middle_s, 0.0);
}

TEST(RegistrationCloud, WithoutTimesRecorrectChangesNothing) {
  CorrectedSweep sweep = numberedSweep();
  sweep.times_s.clear();
  RegistrationCloud cloud;
  RegistrationCloudBuilder(testParams()).build(sweep, Pose::Identity(), cloud);
  const Points before = cloud.map_points_cog;
  cloud.redeskewBy(Vector6d::Constant(1.0));
  EXPECT_EQ(cloud.map_points_cog, before);
}

// Seen straight ahead in the middle of a sweep that begins at the rear, and at the sides a quarter of it before and
// after.
TEST(RegistrationCloud, CompensatedSweepIsTimedByAzimuth) {
  SweepTimingParams head;
  const Pose T_cog_lidar = poseOf(1.0, 0.0, 0.5, 0.0, 0.0, 30.0);
  CorrectedSweep sweep;
  sweep.points_lidar = {{10.0f, 0.0f, 0.0f}, {0.0f, 10.0f, 0.0f}, {0.0f, -10.0f, 0.0f}};
  RegistrationCloud cloud;
  const auto timeOf = [&](const Eigen::Vector3f& point_lidar) {
    const Eigen::Vector3f point = (T_cog_lidar * point_lidar.cast<double>()).cast<float>();
    for (std::size_t i = 0; i < cloud.map_points_cog.size(); ++i) {
      if ((cloud.map_points_cog[i] - point).norm() < 1e-3f) return cloud.map_times_s[i];
    }
    return std::numeric_limits<float>::quiet_NaN();
  };
  for (const bool clockwise : {true, false}) {
    head.clockwise = clockwise;
    RegistrationCloudBuilder(testParams(), head).build(sweep, T_cog_lidar, cloud);
    EXPECT_TRUE(cloud.compensated);
    ASSERT_EQ(cloud.map_times_s.size(), 3u);
    EXPECT_NEAR(timeOf(sweep.points_lidar[0]), 0.0f, 1e-5f);
    EXPECT_NEAR(timeOf(sweep.points_lidar[1]), clockwise ? -0.025f : 0.025f, 1e-5f);
    EXPECT_NEAR(timeOf(sweep.points_lidar[2]), clockwise ? 0.025f : -0.025f, 1e-5f);
    EXPECT_EQ(cloud.plane_times_s.size(), cloud.plane_points_cog.size());
    EXPECT_EQ(cloud.point_times_s.size(), cloud.point_points_cog.size());
  }
  const CorrectedSweep timed = numberedSweep();
  RegistrationCloudBuilder(testParams(), head).build(timed, Pose::Identity(), cloud);
  EXPECT_FALSE(cloud.compensated) << "it has times of its own";
  expectFromSweep(cloud.map_points_cog, cloud.map_times_s, timed, Pose::Identity());
}

TEST(RegistrationCloud, ValidatesItsParameters) {
  const auto rejects = [](auto change) {
    RegistrationCloudBuilder::Params params = testParams();
    change(params);
    EXPECT_THROW(validate(params), ParameterError);
  };
  EXPECT_NO_THROW(validate(RegistrationCloudBuilder::Params()));
  rejects([](auto& p) { p.max_range_m = p.min_range_m; });
  rejects([](auto& p) { p.plane_voxel_m = 0.2; });
  rejects([](auto& p) { p.point_voxel_m = 0.2; });
  rejects([](auto& p) { p.min_points = 0; });
}

}  // namespace
}  // namespace fail_aware::registration_cloud_test
