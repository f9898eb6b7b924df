#include "core/preprocessing/sweep_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "../../support/synthetic_street.hpp"
#include "core/geometry/degree.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::sweep_check_test {
namespace {

Sweep streetSweep(int i) {
  static const synthetic::Street street;
  const synthetic::Drive drive;
  return street.scan([&](double t) { return drive.T_street_base(t); }, 0.1 * i, static_cast<std::uint32_t>(i));
}

void keepOnly(Sweep& sweep, const std::function<bool(const Eigen::Vector3f&)>& keep) {
  std::vector<Eigen::Vector3f> kept;
  for (const Eigen::Vector3f& p : sweep.points_lidar) {
    if (keep(p)) kept.push_back(p);
  }
  sweep.points_lidar = kept;
}

double azimuthDeg(const Eigen::Vector3f& p) { return std::atan2(p.y(), p.x()) / kDegree; }

TEST(SweepCheck, NothingIsWrongWithAStreet) {
  SweepCheck check{SweepCheckParams()};
  for (int i = 0; i < 5; ++i) {
    const SweepFindings findings = check.check(streetSweep(i));
    EXPECT_FALSE(findings.incomplete || findings.low_visibility || findings.frozen || findings.time_jump) << i;
    EXPECT_EQ(findings.azimuth_coverage, 1.0);
    EXPECT_GT(findings.view_range_m, 20.0);
    EXPECT_EQ(findings.repetitions, 0);
  }
}

TEST(SweepCheck, HalfASweepAndABlankedSectorAreIncompleteAtOnce) {
  for (const double from_deg : {-180.0, -90.0, 0.0, 17.0}) {
    SweepCheck check{SweepCheckParams()};
    Sweep sweep = streetSweep(0);
    keepOnly(sweep,
             [&](const Eigen::Vector3f& p) { return std::fmod(azimuthDeg(p) - from_deg + 720.0, 360.0) < 180.0; });
    const SweepFindings findings = check.check(sweep);
    EXPECT_TRUE(findings.incomplete) << from_deg;
    EXPECT_NEAR(findings.azimuth_coverage, 0.5, 0.03) << from_deg;
    EXPECT_FALSE(findings.frozen);
  }
  SweepCheck check{SweepCheckParams()};
  Sweep sweep = streetSweep(0);
  keepOnly(sweep, [](const Eigen::Vector3f& p) { return std::abs(azimuthDeg(p)) > 20.0; });
  EXPECT_FALSE(check.check(sweep).incomplete) << "a van ahead hides 40 deg";
}

TEST(SweepCheck, RangesCutAtTenMetresAreLowVisibility) {
  SweepCheck check{SweepCheckParams()};
  Sweep sweep = streetSweep(0);
  keepOnly(sweep, [](const Eigen::Vector3f& p) { return p.norm() <= 10.0f; });
  const SweepFindings findings = check.check(sweep);
  EXPECT_TRUE(findings.low_visibility);
  EXPECT_NEAR(findings.view_range_m, 10.0, 0.5);
  sweep = streetSweep(1);
  keepOnly(sweep, [](const Eigen::Vector3f& p) { return p.norm() <= 25.0f; });
  EXPECT_FALSE(check.check(sweep).low_visibility);
  SweepCheckParams off;
  off.min_view_range_m = 0.0;
  keepOnly(sweep, [](const Eigen::Vector3f& p) { return p.norm() <= 10.0f; });
  EXPECT_FALSE(SweepCheck(off).check(sweep).low_visibility);
}

TEST(SweepCheck, AFirstSweepThatIsAPartOfARevolutionIsLeftOut) {
  SweepCheck check{SweepCheckParams()};
  EXPECT_FALSE(check.check(Sweep()).partial_start) << "no points";
  Sweep part = streetSweep(0);
  keepOnly(part, [&](const Eigen::Vector3f& p) { return azimuthDeg(p) > 0.0; });
  EXPECT_TRUE(isLeftOut(check.check(part), true));
  EXPECT_FALSE(isLeftOut(check.check(part), true)) << "the lidar sees no more";
  check.reset();
  EXPECT_FALSE(check.check(streetSweep(0)).partial_start);
  EXPECT_FALSE(check.check(part).partial_start) << "a fault";
}

TEST(SweepCheck, ASweepThatRepeatsItselfIsFrozenWithinFive) {
  SweepCheck check{SweepCheckParams()};
  check.check(streetSweep(0));
  const Sweep stuck = streetSweep(1);
  for (int i = 1; i <= 5; ++i) {
    Sweep sweep = stuck;
    sweep.stamp_s = 0.1 * i;
    const SweepFindings findings = check.check(sweep);
    EXPECT_EQ(findings.repetitions, i - 1);
    EXPECT_EQ(findings.repeats, i >= 2) << i;
    EXPECT_EQ(findings.frozen, i >= 4) << i;
  }
  EXPECT_FALSE(check.check(streetSweep(6)).frozen) << "the first new sweep ends it";
  Sweep nearly = streetSweep(6);
  nearly.points_lidar[100].z() = std::nextafter(nearly.points_lidar[100].z(), 10.0f);
  EXPECT_EQ(check.check(nearly).repetitions, 0) << "one bit of one point differs";
}

TEST(SweepCheck, FrozenCanBeSwitchedOff) {
  SweepCheckParams params;
  params.frozen_sweeps = 0;
  SweepCheck check(params);
  for (int i = 0; i < 9; ++i) {
    const SweepFindings findings = check.check(streetSweep(0));
    EXPECT_FALSE(findings.frozen || findings.repeats);
  }
}

TEST(SweepCheck, TimeJumpsBothWays) {
  SweepCheck check{SweepCheckParams()};
  Sweep sweep = streetSweep(0);
  const auto jumpAt = [&](double stamp_s) {
    sweep.stamp_s = stamp_s;
    return check.check(sweep).time_jump;
  };
  EXPECT_FALSE(jumpAt(100.0)) << "the first stamp";
  EXPECT_FALSE(jumpAt(100.5));
  EXPECT_TRUE(jumpAt(101.5));
  EXPECT_FALSE(jumpAt(101.6));
  EXPECT_TRUE(jumpAt(100.0));
  EXPECT_FALSE(jumpAt(100.1));
  check.reset();
  EXPECT_FALSE(jumpAt(7.0));
}

TEST(SweepCheck, AnEmptySweepShowsNothing) {
  SweepCheck check{SweepCheckParams()};
  Sweep empty;
  const SweepFindings findings = check.check(empty);
  EXPECT_FALSE(findings.incomplete || findings.low_visibility || findings.frozen || findings.time_jump);
  for (int i = 0; i < 9; ++i) EXPECT_FALSE(check.check(empty).frozen) << "no points do not repeat";
}

TEST(SweepCheck, ParametersAreChecked) {
  SweepCheckParams params;
  params.min_azimuth_coverage = 1.1;
  EXPECT_THROW(validate(params), ParameterError);
  params = SweepCheckParams();
  params.frozen_sweeps = -1;
  EXPECT_THROW(validate(params), ParameterError);
  params = SweepCheckParams();
  params.max_gap_s = 0.0;
  EXPECT_THROW(validate(params), ParameterError);
}

TEST(SweepCheck, ADriveThatBeginsKeepsTheStampAlone) {
  SweepCheck check{SweepCheckParams()};
  for (int i = 0; i < 3; ++i) check.check(streetSweep(0));
  check.beginDrive();
  Sweep half = streetSweep(0);
  half.stamp_s += 10.0;
  keepOnly(half, [](const Eigen::Vector3f& p) { return azimuthDeg(p) > 0.0; });
  const SweepFindings findings = check.check(half);
  EXPECT_TRUE(findings.partial_start);
  EXPECT_TRUE(findings.time_jump);
  EXPECT_EQ(findings.repetitions, 0);
  EXPECT_FALSE(check.check(half).partial_start);
}

}  // namespace
}  // namespace fail_aware::sweep_check_test
