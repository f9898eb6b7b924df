#include "core/registration/beam_bias_estimator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "../../support/synthetic_drive.hpp"
#include "core/geometry/degree.hpp"
#include "core/preprocessing/registration_cloud.hpp"

namespace fail_aware::beam_bias_estimator_test {
namespace {

constexpr int kBeams = 8;
const std::vector<double> kTooFar_m = {0.03, -0.02, 0.0, 0.05, -0.04, 0.01, -0.03, 0.0};  // mean 0

Pose lidarPose() { return poseOf(0.0, 0.0, 1.5, 0.0, 0.0, 0.0); }

VoxelMap mapOf(const Scene& scene) {
  VoxelMap::Params params;
  params.voxel_size_m = 0.8;
  params.max_plane_sigma_m = 0.03;
  VoxelMap map(params);
  map.insert(seenFrom(sampleScene(scene, 60.0, 0.005, 1), lidarPose()), lidarPose());
  return map;
}

VoxelMap roomMap() { return mapOf(room()); }

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

BeamBiasEstimator driven(int sweeps, const std::vector<double>& too_far_m, const Pose& error = Pose::Identity(),
                         const BeamBiasEstimator::Params& params = {}) {
  const VoxelMap map = roomMap();
  BeamBiasEstimator beams(params, IcpPointToPlane::Params());
  RegistrationCloudBuilder builder(cloudParams());
  RegistrationCloud cloud;
  for (int i = 0; i < sweeps; ++i) {
    builder.build(sweepOf(static_cast<unsigned>(2 + i), too_far_m), Pose::Identity(), cloud, beams.bias());
    beams.observe(cloud.plane_points_cog, cloud.plane_rings, Pose::Identity(), map, lidarPose() * error);
  }
  return beams;
}

void expectFound(const BeamBiasEstimator& beams, double tolerance_m) {
  ASSERT_EQ(beams.bias().too_far_m.size(), kTooFar_m.size());
  for (std::size_t ring = 0; ring < kTooFar_m.size(); ++ring) {
    EXPECT_NEAR(static_cast<double>(beams.bias().too_far_m[ring]), kTooFar_m[ring], tolerance_m) << ring;
  }
}

TEST(BeamBiasEstimator, FindsWhatEachBeamMeasuresTooFar) {
  EXPECT_TRUE(driven(0, kTooFar_m).bias().too_far_m.empty());
  BeamBiasEstimator::Params sure;
  sure.range_m.forget = 0.0;
  expectFound(driven(20, kTooFar_m, Pose::Identity(), sure), 0.004);
  expectFound(driven(20, kTooFar_m), 0.006);
}

TEST(BeamBiasEstimator, APoseThatIsSomeCentimetresOffDoesNotMatter) {
  expectFound(driven(20, kTooFar_m, poseOf(0.02, -0.02, 0.0, 0.0, 0.0, 0.1)), 0.008);
}

TEST(BeamBiasEstimator, WhatAllRangesHaveInCommonIsNotSought) {
  const BeamBiasEstimator beams = driven(10, std::vector<double>(kBeams, 0.04));
  for (const float offset_m : beams.bias().too_far_m) EXPECT_NEAR(static_cast<double>(offset_m), 0.0, 0.004);
}

TEST(BeamBiasEstimator, TheCorrectionBringsThePointsToTheirWalls) {
  const CorrectedSweep crooked = sweepOf(50, kTooFar_m), right = sweepOf(50, std::vector<double>(kBeams, 0.0));
  const BeamBiasEstimator beams = driven(20, kTooFar_m);
  RegistrationCloudBuilder builder(cloudParams());
  RegistrationCloud cloud;
  builder.build(crooked, Pose::Identity(), cloud, beams.bias());
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

constexpr int kElevations = 12;  // beams, one every 2 deg

/// What a head sees, and at which elevation its lowest beam points.
struct View {
  Scene scene = room();
  double lowest_deg = -30.0;  ///< the ground
};

/// Banks on all sides, steep as 45 deg, and only beams that pass over the ground between them.
View banks() {
  return {{{{-20.0, 8.0, kGround_m}, {40.0, 0.0, 0.0}, {0.0, 8.0, 8.0}},
           {{-20.0, -8.0, kGround_m}, {40.0, 0.0, 0.0}, {0.0, -8.0, 8.0}},
           {{12.0, -16.0, kGround_m}, {0.0, 32.0, 0.0}, {8.0, 0.0, 8.0}},
           {{-12.0, -16.0, kGround_m}, {0.0, 32.0, 0.0}, {-8.0, 0.0, 8.0}}},
          -6.0};
}

/// As seen by a head whose beams point `too_high_deg`, mounted at `T_cog_lidar`.
CorrectedSweep elevatedSweep(const View& view, unsigned seed, const std::vector<double>& too_high_deg,
                             const Pose& T_cog_lidar) {
  CorrectedSweep sweep;
  for (const Eigen::Vector3f& p : seenFrom(sampleScene(view.scene, 60.0, 0.005, seed), lidarPose() * T_cog_lidar)) {
    const double distance_m = static_cast<double>(p.head<2>().norm()), z = static_cast<double>(p.z());
    const double elevation_rad = std::atan2(z, distance_m);
    const int ring = static_cast<int>(std::floor((elevation_rad / kDegree - view.lowest_deg) / 2.0));
    if (ring < 0 || ring >= kElevations) continue;
    const double seen_rad = elevation_rad + too_high_deg[static_cast<std::size_t>(ring)] * kDegree;
    const double range_m = std::hypot(distance_m, z);
    const auto scale = static_cast<float>(range_m * std::cos(seen_rad) / distance_m);
    sweep.points_lidar.emplace_back(p.x() * scale, p.y() * scale, static_cast<float>(range_m * std::sin(seen_rad)));
    sweep.rings.push_back(static_cast<std::uint16_t>(ring));
  }
  return sweep;
}

std::vector<double> elevationsFound(const std::vector<double>& too_high_deg, const Pose& error = Pose::Identity(),
                                    const Pose& T_cog_lidar = Pose::Identity(), const View& view = {}) {
  const VoxelMap map = mapOf(view.scene);
  BeamBiasEstimator beams{BeamBiasEstimator::Params(), IcpPointToPlane::Params()};
  RegistrationCloudBuilder builder(cloudParams());
  RegistrationCloud cloud;
  for (unsigned i = 0; i < 20; ++i) {
    builder.build(elevatedSweep(view, 2 + i, too_high_deg, T_cog_lidar), T_cog_lidar, cloud, beams.bias());
    beams.observe(cloud.plane_points_cog, cloud.plane_rings, T_cog_lidar, map, lidarPose() * error);
  }
  std::vector<double> found_deg;
  for (const float angle : beams.bias().too_high_rad) found_deg.push_back(static_cast<double>(angle) / kDegree);
  return found_deg;
}

/// Beams in turn too high and too low: nothing of it varies smoothly.
std::vector<double> alternating(double deg) {
  std::vector<double> all(kElevations, deg);
  for (std::size_t ring = 1; ring < all.size(); ring += 2) all[ring] = -deg;
  return all;
}

void expectAlternating(const std::vector<double>& found_deg, double deg) {
  ASSERT_EQ(found_deg.size(), static_cast<std::size_t>(kElevations));
  for (std::size_t ring = 0; ring < found_deg.size(); ++ring) {
    const double sign = ring % 2 == 0 ? 1.0 : -1.0;  // the smooth part of the first and last beams is not found
    EXPECT_GT(sign * found_deg[ring], 0.3 * deg) << ring;
    EXPECT_LT(sign * found_deg[ring], 1.7 * deg) << ring;
  }
}

TEST(BeamBiasEstimator, FindsWhichBeamsPointTooHigh) { expectAlternating(elevationsFound(alternating(0.2)), 0.2); }

TEST(BeamBiasEstimator, BeamsThatMeetNoGroundAreFoundFromBanks) {
  expectAlternating(elevationsFound(alternating(0.2), Pose::Identity(), Pose::Identity(), banks()), 0.2);
}

TEST(BeamBiasEstimator, ElevationsAreThoseOfATiltedHead) {
  expectAlternating(elevationsFound(alternating(0.2), Pose::Identity(), poseOf(0.0, 0.0, 0.0, 0.0, 2.0, 90.0)), 0.2);
}

TEST(BeamBiasEstimator, APoseThatPitchesIsNoElevationOfABeam) {
  expectAlternating(elevationsFound(alternating(0.2), poseOf(0.0, 0.0, 0.01, 0.0, 0.1, 0.0)), 0.2);
}

TEST(BeamBiasEstimator, WhatVariesSmoothlyOverTheGroundIsNotSought) {
  const std::vector<double> with_deg = elevationsFound(std::vector<double>(kElevations, 0.1));
  const std::vector<double> without_deg = elevationsFound(std::vector<double>(kElevations, 0.0));
  ASSERT_EQ(with_deg.size(), static_cast<std::size_t>(kElevations));
  ASSERT_EQ(without_deg.size(), with_deg.size());
  for (std::size_t ring = 0; ring < with_deg.size(); ++ring) {
    EXPECT_NEAR(with_deg[ring], without_deg[ring], 0.03) << ring;
  }
}

TEST(BeamBiasEstimator, WithoutRingsOrAMapNothingIsKnown) {
  BeamBiasEstimator beams{BeamBiasEstimator::Params(), IcpPointToPlane::Params()};
  const std::vector<Eigen::Vector3f> points = {{5.0f, 0.0f, 0.0f}, {0.0f, 5.0f, 0.0f}};
  beams.observe(points, {}, Pose::Identity(), roomMap(), lidarPose());
  beams.observe(points, {1, 2}, Pose::Identity(), VoxelMap(VoxelMap::Params()), lidarPose());
  EXPECT_TRUE(beams.bias().too_far_m.empty());
  CorrectedSweep sweep = sweepOf(3, kTooFar_m);
  sweep.rings.clear();
  RegistrationCloud cloud;
  RegistrationCloudBuilder(cloudParams()).build(sweep, Pose::Identity(), cloud, {{0.1f, 0.1f}, {}});
  EXPECT_TRUE(cloud.plane_rings.empty());
  beams.observe(cloud.plane_points_cog, cloud.plane_rings, Pose::Identity(), roomMap(), lidarPose());
  EXPECT_TRUE(beams.bias().too_far_m.empty());
}

TEST(BeamBiasEstimator, NumbersThatAreNoBeamsAreLeftOut) {
  BeamBiasEstimator beams{BeamBiasEstimator::Params(), IcpPointToPlane::Params()};
  CorrectedSweep sweep = sweepOf(3, kTooFar_m);
  for (std::uint16_t& ring : sweep.rings) ring = static_cast<std::uint16_t>(ring == 3 ? 60000 : ring);
  RegistrationCloud cloud;
  RegistrationCloudBuilder(cloudParams()).build(sweep, Pose::Identity(), cloud);
  beams.observe(cloud.plane_points_cog, cloud.plane_rings, Pose::Identity(), roomMap(), lidarPose());
  EXPECT_EQ(beams.bias().too_far_m.size(), static_cast<std::size_t>(kBeams));
  EXPECT_EQ(beams.bias().too_far_m[3], 0.0f) << "no point of this beam was valid";
}

TEST(BeamBiasEstimator, UnseenBeamIsAsUncertainAsNew) {
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
    BeamBiasEstimator::Params doubtful;  // one look moves the offset by a part of what is seen
    doubtful.range_m.residual_m = 1.0;
    BeamBiasEstimator beams{doubtful, IcpPointToPlane::Params()};
    RegistrationCloud cloud;
    for (int i = 0; i <= sweeps_without; ++i) {
      RegistrationCloudBuilder(cloudParams())
          .build(i < sweeps_without ? seen(3) : all, Pose::Identity(), cloud, beams.bias());
      beams.observe(cloud.plane_points_cog, cloud.plane_rings, Pose::Identity(), map, lidarPose());
    }
    return static_cast<double>(beams.bias().too_far_m[3]);
  };
  const double new_m = afterOneLook(1);
  EXPECT_GT(new_m, 0.001);
  EXPECT_NEAR(afterOneLook(400), new_m, 0.1 * new_m);
}

TEST(BeamBiasEstimator, IsForgottenWithReset) {
  BeamBiasEstimator beams = driven(3, kTooFar_m);
  EXPECT_FALSE(beams.bias().too_far_m.empty());
  beams.reset();
  EXPECT_TRUE(beams.bias().too_far_m.empty());
}

TEST(BeamBiasEstimator, SwitchedOffLearnsNothing) {
  BeamBiasEstimator::Params params;
  params.enabled = false;
  EXPECT_TRUE(driven(3, kTooFar_m, Pose::Identity(), params).bias().too_far_m.empty());
}

}  // namespace
}  // namespace fail_aware::beam_bias_estimator_test
