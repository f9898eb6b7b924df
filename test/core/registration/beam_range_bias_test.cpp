#include "core/registration/beam_range_bias.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "../../support/synthetic_drive.hpp"
#include "core/geometry/degree.hpp"
#include "core/parameters/check.hpp"
#include "core/preprocessing/registration_cloud.hpp"

namespace fail_aware {
namespace {

constexpr int kBeams = 8;
const std::vector<double> kTooFar_m = {0.03, -0.02, 0.0, 0.05, -0.04, 0.01, -0.03, 0.0};  // mean 0

Pose lidarPose() { return poseOf(0.0, 0.0, 1.5, 0.0, 0.0, 0.0); }

VoxelMap roomMap() {
  VoxelMap::Params params;
  params.voxel_size_m = 0.8;
  params.max_plane_sigma_m = 0.03;
  VoxelMap map(params);
  map.insert(seenFrom(sampleScene(room(), 60.0, 0.005, 1), lidarPose()), lidarPose());
  return map;
}

/// The room as seen by a head of eight beams, one every 2 deg, that measure `too_far_m`.
CorrectedSweep sweepOf(unsigned seed, const std::vector<double>& too_far_m) {
  CorrectedSweep sweep;
  for (const Eigen::Vector3f& p : seenFrom(sampleScene(room(), 60.0, 0.005, seed), lidarPose())) {
    const double elevation_deg = std::asin(static_cast<double>(p.z()) / static_cast<double>(p.norm())) / kDegree;
    const int ring = static_cast<int>(std::floor(elevation_deg / 2.0)) + 3;
    if (ring < 0 || ring >= kBeams) continue;
    const double offset_m = too_far_m[static_cast<std::size_t>(ring)];
    sweep.points_lidar.push_back(p * (1.0f + static_cast<float>(offset_m) / p.norm()));
    sweep.rings.push_back(static_cast<std::uint16_t>(ring));
  }
  return sweep;
}

RegistrationCloudBuilder::Params cloudParams() {
  RegistrationCloudBuilder::Params params;
  params.plane_voxel_m = 0.3;
  return params;
}

BeamRangeBias driven(int sweeps, const std::vector<double>& too_far_m, const Pose& error = Pose::Identity(),
                     const BeamRangeBias::Params& params = {}) {
  const VoxelMap map = roomMap();
  BeamRangeBias beams(params, IcpPointToPlane::Params());
  RegistrationCloudBuilder builder(cloudParams());
  RegistrationCloud cloud;
  for (int i = 0; i < sweeps; ++i) {
    builder.build(sweepOf(static_cast<unsigned>(2 + i), too_far_m), Pose::Identity(), cloud, beams.offsets_m());
    beams.observe(cloud.plane_points_cog, cloud.plane_rings, Eigen::Vector3d::Zero(), map, lidarPose() * error);
  }
  return beams;
}

void expectFound(const BeamRangeBias& beams, double tolerance_m) {
  ASSERT_EQ(beams.offsets_m().size(), kTooFar_m.size());
  for (std::size_t ring = 0; ring < kTooFar_m.size(); ++ring) {
    EXPECT_NEAR(static_cast<double>(beams.offsets_m()[ring]), kTooFar_m[ring], tolerance_m) << ring;
  }
}

TEST(BeamRangeBias, FindsWhatEachBeamIsOffBy) {
  EXPECT_TRUE(driven(0, kTooFar_m).offsets_m().empty());
  BeamRangeBias::Params sure;
  sure.forget = 0.0;
  expectFound(driven(20, kTooFar_m, Pose::Identity(), sure), 0.004);
  expectFound(driven(20, kTooFar_m), 0.006);
}

TEST(BeamRangeBias, APoseThatIsSomeCentimetresOffDoesNotMatter) {
  expectFound(driven(20, kTooFar_m, poseOf(0.02, -0.02, 0.0, 0.0, 0.0, 0.1)), 0.008);
}

TEST(BeamRangeBias, WhatAllBeamsHaveInCommonIsNotSought) {
  const BeamRangeBias beams = driven(10, std::vector<double>(kBeams, 0.04));
  for (const float offset_m : beams.offsets_m()) EXPECT_NEAR(static_cast<double>(offset_m), 0.0, 0.004);
}

TEST(BeamRangeBias, TheCorrectionBringsThePointsToTheirWalls) {
  const CorrectedSweep crooked = sweepOf(50, kTooFar_m), right = sweepOf(50, std::vector<double>(kBeams, 0.0));
  const BeamRangeBias beams = driven(20, kTooFar_m);
  RegistrationCloudBuilder builder(cloudParams());
  RegistrationCloud cloud;
  builder.build(crooked, Pose::Identity(), cloud, beams.offsets_m());
  const std::vector<Eigen::Vector3f> corrected = cloud.map_points_cog;
  builder.build(crooked, Pose::Identity(), cloud);
  ASSERT_EQ(corrected.size(), cloud.map_points_cog.size());
  double before_m = 0.0, after_m = 0.0;
  for (std::size_t i = 0; i < corrected.size(); ++i) {
    const auto it = std::find(crooked.points_lidar.begin(), crooked.points_lidar.end(), cloud.map_points_cog[i]);
    const Eigen::Vector3f& truth = right.points_lidar[static_cast<std::size_t>(it - crooked.points_lidar.begin())];
    before_m += static_cast<double>((cloud.map_points_cog[i] - truth).norm());
    after_m += static_cast<double>((corrected[i] - truth).norm());
  }
  EXPECT_LT(after_m, 0.25 * before_m);
}

TEST(BeamRangeBias, WithoutRingsOrAMapNothingIsKnown) {
  BeamRangeBias beams{BeamRangeBias::Params(), IcpPointToPlane::Params()};
  const std::vector<Eigen::Vector3f> points = {{5.0f, 0.0f, 0.0f}, {0.0f, 5.0f, 0.0f}};
  beams.observe(points, {}, Eigen::Vector3d::Zero(), roomMap(), lidarPose());
  beams.observe(points, {1, 2}, Eigen::Vector3d::Zero(), VoxelMap(VoxelMap::Params()), lidarPose());
  EXPECT_TRUE(beams.offsets_m().empty());
  CorrectedSweep sweep = sweepOf(3, kTooFar_m);
  sweep.rings.clear();
  RegistrationCloud cloud;
  RegistrationCloudBuilder(cloudParams()).build(sweep, Pose::Identity(), cloud, {0.1f, 0.1f});
  EXPECT_TRUE(cloud.plane_rings.empty());
  beams.observe(cloud.plane_points_cog, cloud.plane_rings, Eigen::Vector3d::Zero(), roomMap(), lidarPose());
  EXPECT_TRUE(beams.offsets_m().empty());
}

TEST(BeamRangeBias, NumbersThatAreNoBeamsAreLeftOut) {
  BeamRangeBias beams{BeamRangeBias::Params(), IcpPointToPlane::Params()};
  CorrectedSweep sweep = sweepOf(3, kTooFar_m);
  for (std::uint16_t& ring : sweep.rings) ring = static_cast<std::uint16_t>(ring == 3 ? 60000 : ring);
  RegistrationCloud cloud;
  RegistrationCloudBuilder(cloudParams()).build(sweep, Pose::Identity(), cloud);
  beams.observe(cloud.plane_points_cog, cloud.plane_rings, Eigen::Vector3d::Zero(), roomMap(), lidarPose());
  EXPECT_EQ(beams.offsets_m().size(), static_cast<std::size_t>(kBeams));
  EXPECT_EQ(beams.offsets_m()[3], 0.0f) << "nobody saw it";
}

TEST(BeamRangeBias, UnseenBeamIsAsUncertainAsNew) {
  const CorrectedSweep all = sweepOf(3, kTooFar_m);
  const auto seen = [&](std::uint16_t left_out) {
    CorrectedSweep sweep;
    for (std::size_t i = 0; i < all.rings.size(); ++i) {
      if (all.rings[i] == left_out) continue;
      sweep.points_lidar.push_back(all.points_lidar[i]);
      sweep.rings.push_back(all.rings[i]);
    }
    return sweep;
  };
  const VoxelMap map = roomMap();
  const auto afterOneLook = [&](int sweeps_without) {
    BeamRangeBias::Params doubtful;  // one look moves the offset by a part of what is seen
    doubtful.residual_m = 1.0;
    BeamRangeBias beams{doubtful, IcpPointToPlane::Params()};
    RegistrationCloud cloud;
    for (int i = 0; i <= sweeps_without; ++i) {
      RegistrationCloudBuilder(cloudParams())
          .build(i < sweeps_without ? seen(3) : all, Pose::Identity(), cloud, beams.offsets_m());
      beams.observe(cloud.plane_points_cog, cloud.plane_rings, Eigen::Vector3d::Zero(), map, lidarPose());
    }
    return static_cast<double>(beams.offsets_m()[3]);
  };
  const double new_m = afterOneLook(1);
  EXPECT_GT(new_m, 0.001);
  EXPECT_NEAR(afterOneLook(400), new_m, 0.1 * new_m);
}

TEST(BeamRangeBias, IsForgottenWithReset) {
  BeamRangeBias beams = driven(3, kTooFar_m);
  EXPECT_FALSE(beams.offsets_m().empty());
  beams.reset();
  EXPECT_TRUE(beams.offsets_m().empty());
}

TEST(BeamRangeBias, SwitchedOffLearnsNothing) {
  BeamRangeBias::Params params;
  params.enabled = false;
  EXPECT_TRUE(driven(3, kTooFar_m, Pose::Identity(), params).offsets_m().empty());
}

TEST(BeamRangeBias, ParametersAreChecked) {
  const auto refused = [](auto change) {
    BeamRangeBias::Params params;
    change(params);
    EXPECT_THROW(BeamRangeBias(params, IcpPointToPlane::Params()), ParameterError);
  };
  refused([](auto& p) { p.sigma_m = 0.0; });
  refused([](auto& p) { p.walk_m = -1.0; });
  refused([](auto& p) { p.residual_m = 0.0; });
  refused([](auto& p) { p.kernel_m = std::numeric_limits<double>::quiet_NaN(); });
  refused([](auto& p) { p.forget = 1.5; });
  refused([](auto& p) { p.min_obliqueness = -0.1; });
  refused([](auto& p) { p.max_normal_z = 2.0; });
}

}  // namespace
}  // namespace fail_aware
