#include "core/preprocessing/point_times.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace fail_aware::point_times_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// `count` numbers from `first` on, evenly over `span`, whole ones for integers.
std::vector<double> evenly(double first, double span, std::size_t count = 1001, bool whole = false) {
  std::vector<double> numbers;
  for (std::size_t i = 0; i < count; ++i) {
    const double number = first + span * static_cast<double>(i) / static_cast<double>(count - 1);
    numbers.push_back(whole ? std::floor(number) : number);
  }
  return numbers;
}

TEST(ReadPointTimes, TheSpanTellsTheUnit) {
  const struct {
    double first, span;
    TimeNumber type;
    const char* unit;
    double span_s;
  } cases[] = {
      {-0.1, 0.1, TimeNumber::kFloat32, "s", 0.1},          // velodyne
      {-0.025, 0.05, TimeNumber::kFloat32, "s", 0.05},      // a head at 20 Hz
      {0.0, 1e8, TimeNumber::kInteger, "ns", 0.1},          // ouster
      {0.0, 1e5, TimeNumber::kInteger, "us", 0.1},          //
      {0.0, 99.0, TimeNumber::kInteger, "ms", 0.099},       //
      {0.0, 100.0, TimeNumber::kFloat32, "ms", 0.1},        //
      {0.0, 1e8, TimeNumber::kFloat32, "ns", 0.1},          // ouster of 2019
      {1.7e9, 0.1, TimeNumber::kFloat64, "s", 0.1},         // hesai, robosense
      {1.7e18, 1e8, TimeNumber::kFloat64, "ns", 0.1},       // livox
      {1.7e15, 2e5, TimeNumber::kFloat64, "us", 0.2},       //
      {4711.0, 0.1, TimeNumber::kFloat64, "s", 0.1},        // the lidar's own clock
      {0.0, 0.005, TimeNumber::kFloat32, "s", 0.005},       // part of a sweep: the usual unit of the type
      {0.0, 5e6, TimeNumber::kInteger, "ns", 0.005},        //
      {3.6e9 - 2e5, 1e5, TimeNumber::kInteger, "us", 0.1},  // since the hour
  };
  for (const auto& c : cases) {
    Sweep sweep;
    EXPECT_TRUE(readPointTimes(evenly(c.first, c.span, 1001, c.type == TimeNumber::kInteger), c.type, "t", sweep));
    EXPECT_EQ(sweep.time_field.refused, "");
    EXPECT_STREQ(sweep.time_field.unit, c.unit) << c.first << " " << c.span;
    ASSERT_EQ(sweep.times_s.size(), 1001u);
    EXPECT_NEAR(sweep.times_s.back() - sweep.times_s.front(), c.span_s, 2e-5 * c.span_s + 1e-6) << c.unit;
    const double unit_s = c.span_s / c.span;
    EXPECT_NEAR(sweep.time_field.origin_s + sweep.times_s.front(), c.first * unit_s,
                1e-6 + 1e-9 * c.first * unit_s + 0.05 * c.span_s);
  }
}

TEST(ReadPointTimes, ClockTimesCountFromAnOrigin) {
  Sweep sweep;
  readPointTimes({-0.1, -0.05, 0.0}, TimeNumber::kFloat32, "time", sweep);
  EXPECT_EQ(sweep.time_field.origin_s, 0.0);
  EXPECT_EQ(sweep.times_s, (std::vector<float>{-0.1f, -0.05f, 0.0f}));
  readPointTimes({1.7e9 + 0.02, 1.7e9, 1.7e9 + 0.1}, TimeNumber::kFloat64, "timestamp", sweep);
  EXPECT_EQ(sweep.time_field.origin_s, 1.7e9);
  EXPECT_EQ(sweep.time_field.name, "timestamp");
  EXPECT_NEAR(sweep.times_s[0], 0.02, 1e-6);
  EXPECT_NEAR(sweep.times_s[2], 0.1, 1e-6);
}

TEST(ReadPointTimes, RefusesWhatIsNoSweepInAnyUnitAndSaysWhy) {
  const struct {
    std::vector<double> numbers;
    TimeNumber type;
    const char* reason;
  } cases[] = {
      {evenly(0.0, 5.0), TimeNumber::kFloat32, "span"},                 // 5 s, 5 ms
      {evenly(0.0, 3e12), TimeNumber::kFloat64, "span"},                //
      {evenly(1.7e9, 256.0, 3), TimeNumber::kFloat32, "too coarse"},    // since 1970 in 32 bits: steps of 128 s
      {evenly(0.0, 1.0, 2, true), TimeNumber::kInteger, "too coarse"},  // whole seconds
      {{0.0, kNaN, 0.1}, TimeNumber::kFloat32, "not finite"},
      {std::vector<double>(50, kNaN), TimeNumber::kFloat64, "not finite"},
  };
  for (const auto& c : cases) {
    Sweep sweep;
    sweep.times_s = {1.0f};
    EXPECT_FALSE(readPointTimes(c.numbers, c.type, "t", sweep));
    EXPECT_NE(sweep.time_field.refused.find(c.reason), std::string::npos) << sweep.time_field.refused;
    EXPECT_TRUE(sweep.times_s.empty());
  }
}

TEST(ReadPointTimes, AFieldLeftEmptyIsNotRefused) {
  for (const double value : {0.0, 1.7e9}) {
    Sweep sweep;
    EXPECT_FALSE(readPointTimes(std::vector<double>(100, value), TimeNumber::kFloat32, "time", sweep));
    EXPECT_EQ(sweep.time_field.refused, "");
    EXPECT_EQ(sweep.times_s.size(), 100u);
  }
}

TEST(ReadPointTimes, ATenthOfTheNumbersMayBeAnything) {
  for (const double wrong : {0.0, 1e300, -1e30, kNaN, std::numeric_limits<double>::infinity(), 4711.0}) {
    for (const std::size_t every : {11u, 40000u}) {
      std::vector<double> numbers = evenly(1.7e18, 1e8, 120000);
      for (std::size_t i = 3; i < numbers.size(); i += every) numbers[i] = wrong;
      Sweep sweep;
      EXPECT_TRUE(readPointTimes(numbers, TimeNumber::kFloat64, "timestamp", sweep)) << sweep.time_field.refused;
      EXPECT_STREQ(sweep.time_field.unit, "ns");
      EXPECT_NEAR(sweep.time_field.origin_s + sweep.times_s[60001], 1.7e9 + 0.05, 1e-3);
    }
  }
}

std::vector<float> toFloats(const std::vector<double>& numbers) { return {numbers.begin(), numbers.end()}; }

TEST(RangeOfTimes, IsExactWithoutOutliers) {
  for (const double period_s : {0.0, 0.1}) {
    for (const std::size_t count : {2u, 3u, 100u, 120000u}) {
      const auto range = rangeOfTimes(toFloats(evenly(-0.1, 0.1, count)), period_s);
      ASSERT_TRUE(range.has_value());
      EXPECT_FLOAT_EQ(static_cast<float>(range->first_s), -0.1f);
      EXPECT_FLOAT_EQ(static_cast<float>(range->last_s), 0.0f);
      EXPECT_TRUE(range->contains(-0.1f) && range->contains(0.0f) && range->contains(-0.05f));
    }
  }
}

// A wall on one side takes most of the points, the sky on the other nearly none: no point is an outlier.
TEST(RangeOfTimes, HoldsWhatIsThinlySpread) {
  std::vector<float> times_s = toFloats(evenly(0.06, 0.03, 110000));
  for (const float t : toFloats(evenly(0.0, 0.1, 8000))) times_s.push_back(t);
  const auto range = rangeOfTimes(times_s, 0.1);
  ASSERT_TRUE(range.has_value());
  for (const float t : times_s) ASSERT_TRUE(range->contains(t)) << t;
  EXPECT_NEAR(range->first_s, 0.0, 0.002);
  EXPECT_NEAR(range->last_s, 0.1, 0.002);
}

TEST(RangeOfTimes, IsNotMovedByOutliers) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float wrong : {1e9f, -1e9f, nan, 0.4f, -0.35f}) {
    for (const std::size_t wrong_points : {1u, 3u, 1200u, 9000u}) {
      std::vector<float> times_s = toFloats(evenly(-0.1, 0.1, 120000));
      for (std::size_t i = 0; i < wrong_points; ++i) times_s[i * (120000 / wrong_points) + 7] = wrong;
      const auto range = rangeOfTimes(times_s, 0.1);
      ASSERT_TRUE(range.has_value()) << wrong << " " << wrong_points;
      EXPECT_NEAR(range->first_s, -0.1, 1e-4) << wrong << " " << wrong_points;
      EXPECT_NEAR(range->last_s, 0.0, 1e-4) << wrong << " " << wrong_points;
      EXPECT_FALSE(range->contains(wrong)) << wrong;
    }
  }
  std::vector<float> near = toFloats(evenly(-0.1, 0.1, 120000));
  near[5000] = near[70000] = near[100000] = 0.02f;  // within a revolution and a quarter: kept, but not the sweep's end
  EXPECT_NEAR(rangeOfTimes(near, 0.1)->last_s, 0.0, 0.0021);
}

TEST(RangeOfTimes, IsNoneWhenMoreThanATenthIsNotFinite) {
  std::vector<float> times_s = toFloats(evenly(-0.1, 0.1, 1000));
  for (std::size_t i = 0; i < 1000; i += 8) times_s[i] = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(rangeOfTimes(times_s, 0.1).has_value());
  EXPECT_FALSE(rangeOfTimes({}, 0.1).has_value());
}

}  // namespace
}  // namespace fail_aware::point_times_test
