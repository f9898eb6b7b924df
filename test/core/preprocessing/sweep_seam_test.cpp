#include "core/preprocessing/sweep_seam.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "core/geometry/degree.hpp"

namespace fail_aware::sweep_seam_test {
namespace {

struct Head {
  double start_deg = 180.0;
  bool clockwise = true;
  int columns = 1800, lasers = 64;
  double lasers_aside_deg = 6.0;  ///< half of them to each side
  double turn_deg = 360.0;
};

Eigen::Vector3f pointAt(double azimuth_deg, double range_m) {
  return Eigen::Vector3d(range_m * std::cos(azimuth_deg * kDegree), range_m * std::sin(azimuth_deg * kDegree), -1.0)
      .cast<float>();
}

/// In the order of a driver's packets; some directions see nothing, some points lie next to the head.
std::vector<Eigen::Vector3f> packets(const Head& head) {
  std::mt19937 random(7);
  std::vector<Eigen::Vector3f> points;
  for (int column = 0; column < head.columns; ++column) {
    const double passed_deg = head.turn_deg * column / head.columns;
    const double centre_deg = head.start_deg + (head.clockwise ? -passed_deg : passed_deg);
    for (int laser = 0; laser < head.lasers; ++laser) {
      const double azimuth_deg = centre_deg + head.lasers_aside_deg * (laser % 2 == 0 ? 1.0 : -1.0);
      const double range_m = 5.0 + static_cast<double>(random() % 4000) * 0.01;
      const bool sees_nothing = std::abs(std::remainder(azimuth_deg - 70.0, 360.0)) < 12.0;
      if (sees_nothing || random() % 5 == 0) continue;
      points.push_back(random() % 200 == 0 ? pointAt(static_cast<double>(random() % 360), 0.3)
                                           : pointAt(azimuth_deg, range_m));
    }
  }
  return points;
}

double off_deg(double a, double b) { return std::abs(std::remainder(a - b, 360.0)); }

TEST(SweepSeam, IsWhereThePacketsBegin) {
  for (const double start_deg : {180.0, 0.0, -90.0, 37.0, 359.0}) {
    for (const bool clockwise : {true, false}) {
      for (const int lasers : {16, 64}) {
        Head head;
        head.start_deg = start_deg;
        head.clockwise = clockwise;
        head.lasers = lasers;
        const std::optional<SweepSeam> seam = findSweepSeam(packets(head));
        ASSERT_TRUE(seam) << start_deg;
        EXPECT_LT(off_deg(seam->start_azimuth_deg, start_deg), 3.0);
        EXPECT_EQ(seam->clockwise, clockwise) << start_deg;
      }
    }
  }
}

TEST(SweepSeam, AnotherOrderThanTheTimesTellsNothing) {
  const std::vector<Eigen::Vector3f> in_time = packets(Head());
  std::vector<Eigen::Vector3f> shuffled = in_time;
  std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(3));
  EXPECT_FALSE(findSweepSeam(shuffled));
  for (const int beams : {4, 16, 32, 64}) {
    std::vector<Eigen::Vector3f> by_beam;
    for (int beam = 0; beam < beams; ++beam) {
      for (int i = 0; i < 1800; ++i) by_beam.push_back(pointAt(0.2 * i, 10.0 + beam));
    }
    EXPECT_FALSE(findSweepSeam(by_beam)) << beams;
  }
  EXPECT_FALSE(findSweepSeam({}));
  EXPECT_FALSE(findSweepSeam({in_time.begin(), in_time.begin() + 500}));
  EXPECT_FALSE(findSweepSeam(std::vector<Eigen::Vector3f>(5000, Eigen::Vector3f::Zero())));
}

TEST(SweepSeam, APartOfARevolutionTellsNothing) {
  Head half;
  half.turn_deg = 180.0;
  EXPECT_FALSE(findSweepSeam(packets(half)));
  Head two;
  two.turn_deg = 720.0;
  EXPECT_FALSE(findSweepSeam(packets(two)));
}

std::string contradictionOf(const std::vector<SweepSeam>& seams, const SweepTimingParams& params = {}) {
  SweepSeamCheck check(params);
  for (const SweepSeam& seam : seams) check.observe(seam);
  return check.contradiction();
}

std::vector<SweepSeam> sweeps(std::size_t count, double start_deg, bool clockwise = true) {
  return std::vector<SweepSeam>(count, {start_deg, clockwise});
}

TEST(SweepSeamCheck, StartWithinToleranceIsNoContradiction) {
  for (const double off : {0.0, 9.0, -9.0}) EXPECT_EQ(contradictionOf(sweeps(11, 180.0 + off)), "") << off;
  EXPECT_EQ(contradictionOf(sweeps(11, -179.0)), "") << "the same direction";
}

TEST(SweepSeamCheck, AnotherStartIsNamedWithBothAzimuths) {
  const std::string said = contradictionOf(sweeps(11, -120.0));
  EXPECT_NE(said.find("begin at -120 deg"), std::string::npos) << said;
  EXPECT_NE(said.find("start_azimuth_deg 180"), std::string::npos) << said;
  EXPECT_NE(contradictionOf(sweeps(11, 169.0)), "") << "beyond the tolerance";
  SweepTimingParams params;
  params.start_azimuth_deg = -120.0;
  EXPECT_EQ(contradictionOf(sweeps(11, -120.0), params), "");
}

TEST(SweepSeamCheck, TheOtherTurnIsNamed) {
  const std::string said = contradictionOf(sweeps(11, 180.0, false));
  EXPECT_NE(said.find("turn counter-clockwise"), std::string::npos) << said;
}

TEST(SweepSeamCheck, AStartThatWandersIsSaidToo) {
  std::vector<SweepSeam> wandering;
  for (int i = 0; i < 11; ++i) wandering.push_back({std::remainder(30.0 * i, 360.0), true});
  EXPECT_NE(contradictionOf(wandering), "");
}

TEST(SweepSeamCheck, SingleSweepsCountNothing) {
  std::vector<SweepSeam> seams = sweeps(11, 180.0);
  for (const std::size_t i : {2u, 5u, 6u, 9u}) seams[i].start_azimuth_deg = 0.0;
  EXPECT_EQ(contradictionOf(seams), "");
  EXPECT_EQ(contradictionOf(sweeps(2, 0.0)), "") << "too few yet";
  EXPECT_NE(contradictionOf(sweeps(3, 0.0)), "");
  std::vector<SweepSeam> mended = sweeps(11, 0.0);
  for (int i = 0; i < 7; ++i) mended.push_back({180.0, true});
  EXPECT_EQ(contradictionOf(mended), "") << "forgotten";
}

}  // namespace
}  // namespace fail_aware::sweep_seam_test
