#include "core/preprocessing/held_timing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/geometry/degree.hpp"

namespace fail_aware::held_timing_test {
namespace {

struct Head {
  double start_deg;
  bool clockwise;
  double revolution_s = 0.1;
};

/// The points of [from_s, to_s) of a revolution that begins at the head's start.
Sweep sweepOf(const Head& head, double from_s, double to_s, double stamp_s) {
  Sweep sweep;
  sweep.stamp_s = stamp_s;
  for (double t = from_s; t < to_s - 1e-9; t += head.revolution_s / 3000.0) {
    const double turned = (head.clockwise ? -1.0 : 1.0) * 2.0 * M_PI * t / head.revolution_s;
    const double yaw = head.start_deg * kDegree + turned;
    sweep.points_lidar.push_back((7.0 * Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0.1)).cast<float>());
    sweep.times_s.push_back(static_cast<float>(t - from_s));
  }
  return sweep;
}

void expectTimes(const std::vector<float>& times_s, const Sweep& sweep, double first_s, const std::string& what) {
  ASSERT_EQ(times_s.size(), sweep.size()) << what;
  for (std::size_t i = 20; i + 20 < times_s.size(); ++i) {  // the seam's points may be either end's
    ASSERT_NEAR(times_s[i], first_s + sweep.times_s[i], 5e-4) << what << ", point " << i;
  }
}

TEST(HeldTiming, TimesASweepAsTheOneBeforeItForAnyHeadAndReference) {
  for (const double start_deg : {180.0, 0.0, -72.5}) {
    for (const bool clockwise : {true, false}) {
      for (const double first_s : {0.0, -0.05, -0.1}) {
        const Head head{start_deg, clockwise};
        const Sweep sweep = sweepOf(head, 0.0, 0.1, 50.0);
        std::vector<float> times_s = sweep.times_s;
        for (float& t : times_s) t += static_cast<float>(first_s);
        for (std::size_t i = 0; i < times_s.size(); i += 50) times_s[i] = std::numeric_limits<float>::quiet_NaN();
        HeldTiming held;
        EXPECT_FALSE(held.apply(sweep, times_s));
        held.keep(HeldTiming::headOf(sweep, times_s, first_s, 0.1));
        const Sweep next = sweepOf(head, 0.0, 0.1, 50.3);  // two were lost
        ASSERT_TRUE(held.apply(next, times_s));
        expectTimes(times_s, next, first_s, std::to_string(start_deg));
        held.reset();
        EXPECT_FALSE(held.apply(next, times_s));
      }
    }
  }
}

TEST(HeldTiming, KnowsWhereTheNextPartOfARevolutionBegins) {
  for (const int parts : {2, 3, 4}) {
    const double part_s = 0.1 / parts;
    const Head head{180.0, true};
    const auto part = [&](int i) {
      return sweepOf(head, i % parts * part_s, (i % parts + 1) * part_s, 9.0 + i * part_s);
    };
    HeldTiming held;
    held.keep(HeldTiming::headOf(part(0), part(0).times_s, 0.0, part_s));
    for (int i = 1; i < 6; ++i) {
      std::vector<float> times_s;
      ASSERT_TRUE(held.apply(part(i), times_s)) << parts;
      expectTimes(times_s, part(i), 0.0, std::to_string(parts) + " parts, part " + std::to_string(i));
    }
  }
}

TEST(HeldTiming, HoldsNothingWhereTheAzimuthDoesNotFollowTheTimes) {
  Sweep sweep = sweepOf({180.0, true}, 0.0, 0.1, 1.0);
  for (std::size_t i = 0; i < sweep.size(); ++i) {  // a rosette
    const double yaw = 0.6 * std::sin(0.37 * static_cast<double>(i));
    sweep.points_lidar[i] = {static_cast<float>(std::cos(yaw)), static_cast<float>(std::sin(yaw)), 0.0f};
  }
  HeldTiming held;
  held.keep(HeldTiming::headOf(sweep, sweep.times_s, 0.0, 0.1));
  std::vector<float> times_s;
  EXPECT_FALSE(held.apply(sweep, times_s));
  held.keep(HeldTiming::headOf(Sweep(), {}, 0.0, 0.1));
  EXPECT_FALSE(held.apply(sweep, times_s));
}

}  // namespace
}  // namespace fail_aware::held_timing_test
