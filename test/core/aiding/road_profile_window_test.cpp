#include "core/aiding/road_profile_window.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "../../support/synthetic_tunnel.hpp"

namespace fail_aware::road_profile_window_test {
namespace {

constexpr double kSpeed_mps = 13.0;

Pose at(double x_m) {
  Pose T_odom_cog = Pose::Identity();
  T_odom_cog.translation().x() = x_m;
  return T_odom_cog;
}

class RoadProfileWindowTest : public testing::Test {
 protected:
  void add(int k, const Pose& T_odom_cog) {
    synthetic::Tunnel tunnel;
    tunnel.profile_m = 0.006;
    const Sweep seen = tunnel.scan(100.0, kSpeed_mps, 0.1 * k, static_cast<std::uint32_t>(k));
    CorrectedSweep sweep;
    sweep.stamp_s = seen.stamp_s;
    sweep.points_lidar = seen.points_lidar;
    Pose T_cog_lidar = Pose::Identity();
    T_cog_lidar.translation() = Eigen::Vector3d(-0.6, 0.0, 1.2);
    window.add(sweep, T_cog_lidar, Vector6d::Zero(), T_odom_cog);
  }

  RoadProfileWindow window{5, 0.25, 1.5};
};

TEST_F(RoadProfileWindowTest, ProfilesLieAtTheEstimatedPoses) {
  for (int k = 0; k < 8; ++k) {
    add(k, at(0.0));
    window.setPose(at(1.3 * k));
  }
  add(8, at(10.0));
  const std::vector<RoadProfile> profiles = window.profiles(0.0);
  ASSERT_EQ(profiles.size(), 5u);
  EXPECT_NEAR(profiles.front().age_s, 0.4, 1e-9);
  EXPECT_NEAR(profiles.front().T_newest_this.translation().x(), 1.3 * 4 - 10.0, 1e-9);
  EXPECT_TRUE(profiles.back().T_newest_this.isApprox(Pose::Identity(), 1e-12));
  for (const RoadProfile& profile : profiles) EXPECT_GT(profile.cells.size(), 500u);
}

TEST_F(RoadProfileWindowTest, APathEndsAtTheNewestSweepAndMovesWithIt) {
  for (int k = 0; k < 5; ++k) add(k, at(0.0));
  window.setPath(10.0, 2.0);
  EXPECT_NEAR(window.profiles(0.0).front().T_newest_this.translation().x(), -4.0 + 0.16, 1e-9);
  window.setPose(at(7.0));
  EXPECT_NEAR(window.profiles(0.0).front().T_newest_this.translation().x(), -4.0 + 0.16, 1e-9);
  window.setPose(at(8.0));
  EXPECT_NEAR(window.profiles(0.0).front().T_newest_this.translation().x(), -5.0 + 0.16, 1e-9) << "moved once";
}

// Alike: at standstill all sweeps are, and nothing is left to subtract.
TEST_F(RoadProfileWindowTest, ASweepsMeanLeavesOutWhatIsAlike) {
  for (int k = 0; k < 5; ++k) add(k, at(0.0));
  EXPECT_GT(window.profiles(0.0).back().cells.size(), 500u);
  EXPECT_TRUE(window.profiles(1.0).back().cells.empty());
}

TEST_F(RoadProfileWindowTest, ForgetsAllAfterAGap) {
  for (int k = 0; k < 5; ++k) add(k, at(0.0));
  add(16, at(0.0));
  EXPECT_EQ(window.size(), 1u);
  window.clear();
  EXPECT_EQ(window.size(), 0u);
  EXPECT_TRUE(window.profiles(1.0).empty());
}

}  // namespace
}  // namespace fail_aware::road_profile_window_test
