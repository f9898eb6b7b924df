#include "simulation/sweep_faults.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/degree.hpp"

namespace fail_aware::sweep_faults_test {
namespace {

constexpr float kGhostIntensity = 0.05f;

/// A cylinder of 10 m radius: 100 columns of 64 rings; the intensity is the ring.
Sweep cylinder() {
  Sweep sweep;
  sweep.stamp_s = 3.0;
  for (int column = 0; column < 100; ++column) {
    for (int ring = 0; ring < 64; ++ring) {
      const double yaw = M_PI - 2.0 * M_PI * (column + 0.5) / 100.0;
      const Eigen::Vector3d p(10.0 * std::cos(yaw), 10.0 * std::sin(yaw), 0.1 * ring - 3.0);
      sweep.points_lidar.push_back(p.cast<float>());
      sweep.intensities.push_back(static_cast<float>(ring));
      sweep.times_s.push_back(static_cast<float>(0.001 * column));
      sweep.rings.push_back(static_cast<std::uint16_t>(ring));
    }
  }
  return sweep;
}

void expectConsistent(const Sweep& sweep) {
  ASSERT_EQ(sweep.intensities.size(), sweep.size());
  ASSERT_EQ(sweep.times_s.size(), sweep.size());
  ASSERT_EQ(sweep.rings.size(), sweep.size());
  for (std::size_t i = 0; i < sweep.size(); ++i) {
    if (sweep.intensities[i] == kGhostIntensity) continue;
    ASSERT_EQ(sweep.intensities[i], static_cast<float>(sweep.rings[i]));
  }
  EXPECT_EQ(sweep.stamp_s, 3.0);
}

TEST(SweepFaults, BlankedSectorIsAhead) {
  Sweep sweep = cylinder();
  blankSector(sweep, 90.0);
  expectConsistent(sweep);
  EXPECT_NEAR(static_cast<double>(sweep.size()), 4800.0, 130.0);
  for (const Eigen::Vector3f& p : sweep.points_lidar) EXPECT_GT(std::abs(std::atan2(p.y(), p.x())), 0.78f);
}

TEST(SweepFaults, LostRingsAreLostForGood) {
  Sweep first = cylinder(), second = cylinder(), all = cylinder();
  loseRings(first, 0.5, 4);
  loseRings(second, 0.5, 4);
  EXPECT_EQ(first.rings, second.rings);
  expectConsistent(first);
  EXPECT_GT(first.size(), 1600u);
  EXPECT_LT(first.size(), 4800u);
  EXPECT_EQ(first.size() % 100, 0u);
  loseRings(all, 1.0, 4);
  EXPECT_TRUE(all.empty());
}

TEST(SweepFaults, RangeCapAndHalfSweep) {
  Sweep sweep = cylinder();
  capRange(sweep, 10.2);
  expectConsistent(sweep);
  EXPECT_GT(sweep.size(), 1000u);
  for (const Eigen::Vector3f& p : sweep.points_lidar) EXPECT_LE(p.norm(), 10.2f);
  sweep = cylinder();
  cutShort(sweep, 0.5);
  expectConsistent(sweep);
  EXPECT_EQ(sweep.size(), 3200u);
  EXPECT_LT(sweep.times_s.back(), 0.05f);
}

TEST(SweepFaults, NoiseAndGhosts) {
  const Sweep clean = cylinder();
  Sweep sweep = clean;
  addNoise(sweep, 0.2, 5);
  double sum2 = 0.0;
  for (std::size_t i = 0; i < clean.size(); ++i) {
    sum2 += static_cast<double>((sweep.points_lidar[i] - clean.points_lidar[i]).squaredNorm());
  }
  EXPECT_NEAR(std::sqrt(sum2 / 3.0 / static_cast<double>(clean.size())), 0.2, 0.005);
  sweep = clean;
  addGhosts(sweep, 0.25, 5);
  expectConsistent(sweep);
  ASSERT_EQ(sweep.size(), 8000u);
  for (std::size_t i = clean.size(); i < sweep.size(); ++i) EXPECT_LT(sweep.points_lidar[i].norm(), 10.5f);
}

TEST(SweepFaults, TiltForwardRaisesWhatIsAhead) {
  Sweep sweep;
  sweep.points_lidar = {{10, 0, 0}, {0, 10, 0}};
  tiltMount(sweep, 2.0);
  EXPECT_NEAR(sweep.points_lidar[0].z(), 10.0 * std::sin(2.0 * kDegree), 2e-2);
  EXPECT_LT(sweep.points_lidar[1].z(), -0.1f);  // leaning to the right, what is on the left sinks
  EXPECT_NEAR(sweep.points_lidar[0].norm(), 10.0f, 1e-5f);
}

TEST(SweepFaults, EmptyAndNan) {
  Sweep sweep = cylinder();
  makeNan(sweep, 0.3, 6);
  int bad = 0;
  for (const Eigen::Vector3f& p : sweep.points_lidar) bad += !p.allFinite();
  EXPECT_NEAR(bad / 6400.0, 0.3, 0.02);
  makeEmpty(sweep);
  expectConsistent(sweep);
  EXPECT_TRUE(sweep.empty());
}

TEST(SweepFaults, SweepsWithoutSideArraysAndEmptyOnes) {
  Sweep sweep;
  sweep.points_lidar = {{1, 2, 3}, {-4, 5, 6}};
  blankSector(sweep, 10.0);
  loseRings(sweep, 1.0, 1);
  addGhosts(sweep, 1.0, 1);
  EXPECT_EQ(sweep.size(), 4u);
  EXPECT_TRUE(sweep.rings.empty());
  makeEmpty(sweep);
  addGhosts(sweep, 1.0, 1);
  EXPECT_TRUE(sweep.empty());
}

}  // namespace
}  // namespace fail_aware::sweep_faults_test
