#include "core/preprocessing/upright_profiles.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <vector>

#include "core/geometry/degree.hpp"

namespace fail_aware::upright_profiles_test {
namespace {

using Kind = UprightProfile::Kind;

struct Points {
  std::vector<Eigen::Vector3f> points;
  std::vector<std::uint16_t> rings;

  void add(double x, double y, double z, int ring) {
    points.push_back(Eigen::Vector3d(x, y, z).cast<float>());
    rings.push_back(static_cast<std::uint16_t>(ring));
  }
};

/// Ahead, from y = 0.1 to 0.9: beam k is met at the height -1.1 + 0.15 k. recess_m(y, z): how far the wall stands back.
template <class Recess>
Points wall(const Recess& recess_m) {
  Points wall;
  for (int beam = 0; beam < 12; ++beam) {
    for (double y = 0.1; y < 0.9; y += 0.05)
      wall.add(10.3 + recess_m(y, -1.1 + 0.15 * beam), y, -1.1 + 0.15 * beam, beam);
  }
  return wall;
}

Points flatWall() {
  return wall([](double, double) { return 0.0; });
}

TEST(UprightProfiles, AWallGivesOneProfileAlongItsNormal) {
  const Points in = flatWall();
  UprightProfileFinder finder;
  finder.find(in.points, in.rings, {}, Eigen::Matrix3d::Identity());
  ASSERT_EQ(finder.profiles().size(), 1u);
  const UprightProfile& profile = finder.profiles().front();
  EXPECT_EQ(profile.kind, Kind::kSurface);
  EXPECT_NEAR(std::abs(profile.direction.x()), 1.0, 1e-4);
  ASSERT_EQ(profile.size, 12u);
  for (std::size_t i = 0; i < profile.size; ++i) {
    const UprightProfile::Beam& beam = finder.beams()[profile.first + i];
    EXPECT_EQ(beam.ring, i);
    EXPECT_EQ(beam.points, 16.0f);
    EXPECT_NEAR(beam.offset_m, 0.0, 1e-3);
    EXPECT_NEAR(beam.height_m, -1.1 + 0.15 * static_cast<double>(i), 1e-4);
    EXPECT_GT(std::abs(beam.obliqueness), 0.98f);
  }
}

TEST(UprightProfiles, HeightsAreThoseAboveTheSensorInOdom) {
  const Points in = flatWall();
  const Eigen::Matrix3d nose_down(Eigen::AngleAxisd(2.0 * kDegree, Eigen::Vector3d::UnitY()));
  UprightProfileFinder finder;
  finder.find(in.points, in.rings, {}, nose_down);
  ASSERT_FALSE(finder.profiles().empty());
  const UprightProfile& profile = finder.profiles().front();
  const UprightProfile::Beam& low = finder.beams()[profile.first];
  const UprightProfile::Beam& high = finder.beams()[profile.first + profile.size - 1];
  EXPECT_NEAR(low.height_m, -1.1 - 10.3 * std::sin(2.0 * kDegree), 0.01);
  const double slope =
      static_cast<double>(high.offset_m - low.offset_m) / static_cast<double>(high.height_m - low.height_m);
  EXPECT_NEAR(slope * profile.direction.x(), std::tan(2.0 * kDegree), 1e-3);
}

TEST(UprightProfiles, AWindowsRecessIsLeftOut) {
  const Points in = wall([](double y, double z) { return z > -0.2 && z < 0.3 && y > 0.5 ? 0.18 : 0.0; });
  UprightProfileFinder finder;
  finder.find(in.points, in.rings, {}, Eigen::Matrix3d::Identity());
  ASSERT_EQ(finder.profiles().size(), 1u);
  for (const UprightProfile::Beam& beam : finder.beams()) EXPECT_NEAR(beam.offset_m, 0.0, 2e-3);
}

TEST(UprightProfiles, TwoThingsInOneColumnGiveNone) {
  const Points in = wall([](double y, double z) { return y > 0.5 ? 0.35 + 0.1 * z : 0.0; });
  UprightProfileFinder finder;
  finder.find(in.points, in.rings, {}, Eigen::Matrix3d::Identity());
  EXPECT_TRUE(finder.profiles().empty());
}

TEST(UprightProfiles, APoleGivesItsMiddleAcrossAndItsMeanAway) {
  Points in;
  for (int beam = 0; beam < 14; ++beam) {
    // one edge is met by more points than the other
    for (const double y : {0.40, 0.42, 0.44, 0.56}) in.add(12.5 + 0.01 * beam, y, -1.1 + 0.14 * beam, beam);
  }
  UprightProfileFinder finder;
  finder.find(in.points, in.rings, {}, Eigen::Matrix3d::Identity());
  ASSERT_EQ(finder.profiles().size(), 2u);
  const UprightProfile& across = finder.profiles()[0];
  const UprightProfile& away = finder.profiles()[1];
  EXPECT_EQ(across.kind, Kind::kLineAcross);
  EXPECT_EQ(away.kind, Kind::kLineAway);
  EXPECT_NEAR(across.direction.dot(away.direction), 0.0, 1e-6);
  const auto slopeOf = [&](const UprightProfile& profile) {
    const UprightProfile::Beam& low = finder.beams()[profile.first];
    const UprightProfile::Beam& high = finder.beams()[profile.first + profile.size - 1];
    return (high.offset_m - low.offset_m) / (high.height_m - low.height_m);
  };
  EXPECT_EQ(finder.beams()[across.first].obliqueness, 0.0f);
  EXPECT_NEAR(slopeOf(across), 0.0, 0.005);
  EXPECT_NEAR(slopeOf(away), 0.01 / 0.14, 0.005);
}

/// The border of a column cuts a sliver out of a wall that passes its corner. The sliver is narrow, and its edge
/// upright.
TEST(UprightProfiles, AWallThatPassesACornerGivesNoLine) {
  for (const double corner_m : {0.1, 0.2, 0.3}) {
    Points in;
    for (int beam = 0; beam < 14; ++beam) {
      const double z = -1.1 + 0.14 * beam, lean_m = 0.05 * z;
      for (double t = -2.0; t < 2.0; t += 0.04) in.add(10.0 + corner_m - t + lean_m, t + lean_m, z, beam);
    }
    UprightProfileFinder finder;
    finder.find(in.points, in.rings, {}, Eigen::Matrix3d::Identity());
    EXPECT_FALSE(finder.profiles().empty());
    for (const UprightProfile& profile : finder.profiles()) EXPECT_EQ(profile.kind, Kind::kSurface) << corner_m;
  }
}

TEST(UprightProfiles, TwoThingsInOppositeCornersAreHarmless) {
  Points in;
  for (int i = 0; i < 8; ++i) {
    in.add(10.09 + 0.001 * i, 0.09, -1.1 + 0.001 * i, i);
    in.add(10.91 - 0.001 * i, 0.91, 2.9 - 0.001 * i, 20 + i);
  }
  UprightProfileFinder finder;
  finder.find(in.points, in.rings, {}, Eigen::Matrix3d::Identity());
  EXPECT_TRUE(finder.profiles().empty());
}

TEST(UprightProfiles, ATrunkOnABorderIsSeenOnceAndWhole) {
  Points in;
  for (int beam = 0; beam < 14; ++beam) {
    const double z = -1.1 + 0.14 * beam;
    for (double y = -0.15; y < 0.16; y += 0.03) in.add(12.5, 0.02 + y + 0.03 * z, z, beam);
  }
  UprightProfileFinder finder;
  finder.find(in.points, in.rings, {}, Eigen::Matrix3d::Identity());
  ASSERT_EQ(finder.profiles().size(), 2u);
  const UprightProfile& across = finder.profiles()[0];
  ASSERT_EQ(across.kind, Kind::kLineAcross);
  const UprightProfile::Beam& low = finder.beams()[across.first];
  const UprightProfile::Beam& high = finder.beams()[across.first + across.size - 1];
  EXPECT_EQ(low.points, 11.0f);
  EXPECT_NEAR((high.offset_m - low.offset_m) / (high.height_m - low.height_m), 0.03, 1e-3);
}

TEST(UprightProfiles, GroundBanksAndCeilingsGiveNone) {
  Points in;
  for (int beam = 0; beam < 12; ++beam) {
    for (double y = 0.1; y < 0.9; y += 0.05) {
      in.add(10.1 + 0.07 * beam, y, -1.15, beam);               // ground
      in.add(12.1 + 0.06 * beam, y, -1.0 + 0.10 * beam, beam);  // a bank
      in.add(14.3, y, -1.1 + 0.04 * beam, beam);                // a curb
    }
  }
  UprightProfileFinder finder;
  finder.find(in.points, in.rings, {}, Eigen::Matrix3d::Identity());
  EXPECT_TRUE(finder.profiles().empty());
}

TEST(UprightProfiles, WithoutRingsElevationsTellTheBeams) {
  const Points in = flatWall();
  UprightProfileFinder finder;
  finder.find(in.points, {}, {}, Eigen::Matrix3d::Identity());
  ASSERT_EQ(finder.profiles().size(), 1u);
  EXPECT_GE(finder.profiles().front().size, 12u);
}

TEST(UprightProfiles, UnreadablePointsAndRingsAreHarmless) {
  Points in = flatWall();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  in.points.push_back({nan, 1.0f, 0.0f});
  in.rings.push_back(3);
  in.points.push_back({1e30f, -1e30f, 0.0f});
  in.rings.push_back(3);
  in.points.push_back({10.3f, 0.5f, 0.0f});
  in.rings.push_back(65535);
  UprightProfileFinder finder;
  finder.find(in.points, in.rings, {}, Eigen::Matrix3d::Identity());
  EXPECT_EQ(finder.profiles().size(), 1u);
  finder.find({}, {}, {}, Eigen::Matrix3d::Identity());
  EXPECT_TRUE(finder.profiles().empty());
  EXPECT_TRUE(finder.beams().empty());
}

}  // namespace
}  // namespace fail_aware::upright_profiles_test
