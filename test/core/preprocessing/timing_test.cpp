#include "core/preprocessing/timing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/geometry/degree.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::timing_test {
namespace {

constexpr double kPeriod_s = 0.1036;

SweepTimingParams paramsWith(const std::string& source, const std::string& reference = "auto") {
  SweepTimingParams params;
  params.source = source;
  params.stamp_reference = reference;
  params.sweep_period_s = kPeriod_s;
  return params;
}

Sweep sweepAt(const std::vector<double>& yaws_rad, double stamp_s = 100.0) {
  Sweep sweep;
  sweep.stamp_s = stamp_s;
  for (const double yaw : yaws_rad) {
    sweep.points_lidar.push_back((8.0 * Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0.1)).cast<float>());
  }
  return sweep;
}

Sweep sweepWithField(const std::vector<float>& times_s, double stamp_s = 100.0) {
  Sweep sweep = sweepAt(std::vector<double>(times_s.size(), 0.3), stamp_s);
  sweep.times_s = times_s;
  return sweep;
}

TEST(SweepTiming, AzimuthRunsFromTheRearThroughLeftFrontRight) {
  SweepTiming timing(paramsWith("azimuth", "start"));
  std::vector<float> times_s;
  const double rear = M_PI - 1e-6, left = M_PI / 2.0, front = 0.0, right = -M_PI / 2.0;
  const TimingResult result = timing.assign(sweepAt({rear, left, front, right, -rear}), 0.0, times_s);
  EXPECT_TRUE(result.ok());
  EXPECT_EQ(result.source, TimingSource::kAzimuth);
  ASSERT_EQ(times_s.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(times_s[i], 0.25 * kPeriod_s * static_cast<double>(i), 1e-6);
}

TEST(SweepTiming, AzimuthAgreesWithAtan2ForAnyStartAndDirection) {
  std::vector<double> yaws;
  for (int i = 0; i < 5000; ++i) yaws.push_back(-M_PI + 2.0 * M_PI * (i + 0.5) / 5000);
  const Sweep sweep = sweepAt(yaws);
  for (const double start_deg : {180.0, 0.0, -90.0, 37.3, 270.0}) {
    for (const bool clockwise : {true, false}) {
      SweepTimingParams params = paramsWith("azimuth", "start");
      params.start_azimuth_deg = start_deg;
      params.clockwise = clockwise;
      std::vector<float> times_s;
      SweepTiming(params).assign(sweep, 0.0, times_s);
      for (std::size_t i = 0; i < yaws.size(); ++i) {
        double turned = (clockwise ? 1.0 : -1.0) * (start_deg * kDegree - yaws[i]) / (2.0 * M_PI);
        turned -= std::floor(turned);
        if (turned < 1e-5 || turned > 1.0 - 1e-5) continue;  // the seam: either end is right
        ASSERT_NEAR(times_s[i] / kPeriod_s, turned, 1e-4 / (2.0 * M_PI)) << start_deg << " " << clockwise << " " << i;
      }
    }
  }
}

TEST(SweepTiming, AzimuthIsFiniteOnTheAxes) {
  Sweep sweep;
  sweep.points_lidar = {{0, 0, 0},  {0, 0, 3},     {-0.0f, -0.0f, 3},    {0, 2, 0},        {0, -2, 0},
                        {-2, 0, 0}, {2, -0.0f, 0}, {1e-20f, -1e-20f, 0}, {3e4f, -3e4f, 0}, {3e38f, 3e38f, 0}};
  std::vector<float> times_s;
  SweepTiming(paramsWith("azimuth", "start")).assign(sweep, 0.0, times_s);
  for (const float t : times_s) EXPECT_TRUE(t >= 0.0f && t <= static_cast<float>(kPeriod_s)) << t;
  EXPECT_NEAR(times_s[3], 0.25 * kPeriod_s, 1e-6);
  EXPECT_NEAR(times_s[4], 0.75 * kPeriod_s, 1e-6);
  EXPECT_NEAR(times_s[5], 0.0, 1e-6);
  EXPECT_NEAR(times_s[6], 0.5 * kPeriod_s, 1e-6);
}

TEST(SweepTiming, StampReferenceSetsTheInterval) {
  const Sweep sweep = sweepAt({M_PI - 1e-5, 0.0, -M_PI + 1e-5});
  const struct {
    const char* reference;
    double first;
  } cases[] = {{"start", 0.0}, {"mid", -0.5}, {"end", -1.0}, {"auto", -1.0}};
  for (const auto& c : cases) {
    std::vector<float> times_s;
    SweepTiming(paramsWith("azimuth", c.reference)).assign(sweep, 0.0, times_s);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(times_s[static_cast<std::size_t>(i)], (c.first + 0.5 * i) * kPeriod_s, 2e-6) << c.reference;
    }
  }
}

TEST(SweepTiming, FieldSetsTheReference) {
  const float T = static_cast<float>(kPeriod_s);
  const struct {
    std::vector<float> field;
    StampReference automatic;
    double zero;
  } fields[] = {{{0.0f, 0.4f * T, T}, StampReference::kStart, 0.0},
                {{-T, -0.6f * T, 0.0f}, StampReference::kEnd, 1.0},
                {{-T, -0.6f * T, 0.001f}, StampReference::kEnd, 1.0},  // points of the last packet, after its stamp
                {{-0.5f * T, -0.1f * T, 0.5f * T}, StampReference::kMid, 0.5}};
  const struct {
    const char* name;
    StampReference reference;
    double position;
  } references[] = {
      {"start", StampReference::kStart, 0.0}, {"mid", StampReference::kMid, 0.5}, {"end", StampReference::kEnd, 1.0}};
  for (const auto& f : fields) {
    std::vector<float> times_s;
    const TimingResult automatic = SweepTiming(paramsWith("auto")).assign(sweepWithField(f.field), 0.0, times_s);
    EXPECT_EQ(automatic.source, TimingSource::kField);
    EXPECT_EQ(automatic.reference, f.automatic);
    EXPECT_EQ(times_s, f.field);
    for (const auto& r : references) {
      const TimingResult given = SweepTiming(paramsWith("field", r.name)).assign(sweepWithField(f.field), 0.0, times_s);
      EXPECT_TRUE(given.ok());
      EXPECT_EQ(given.reference, r.reference);
      for (std::size_t i = 0; i < f.field.size(); ++i) {
        EXPECT_NEAR(times_s[i], f.field[i] + (f.zero - r.position) * kPeriod_s, 1e-6) << r.name;
      }
    }
  }
}

TEST(SweepTiming, AbsoluteFieldIsTakenRelativeToTheStamp) {
  std::vector<float> times_s;
  const TimingResult result =
      SweepTiming(paramsWith("auto")).assign(sweepWithField({99.9f, 99.95f, 100.0f}, 100.0), 0.0, times_s);
  EXPECT_EQ(result.field, TimeField::kUsed);
  EXPECT_EQ(result.reference, StampReference::kEnd);
  EXPECT_NEAR(times_s[0], -0.1, 1e-5);
  EXPECT_NEAR(times_s[2], 0.0, 1e-5);
}

TEST(SweepTiming, AbsoluteFieldCountsFromTheStampWithoutItsJitter) {
  std::vector<float> times_s;
  SweepTiming timing(paramsWith("auto"));
  double now_s = 100.0;
  const auto firstOf = [&](double stamp_s, double stamp_error_s) {
    const auto at = [&](double ago_s) { return static_cast<float>(now_s - ago_s); };
    EXPECT_TRUE(
        timing.assign(sweepWithField({at(0.1), at(0.05), at(0.0)}, stamp_s), kPeriod_s, times_s, stamp_error_s).ok());
    now_s += kPeriod_s;
    return times_s.front();
  };
  EXPECT_NEAR(firstOf(now_s, 0.0), -0.1, 1e-4);
  for (const double jitter_s : {0.01, -0.02, 0.06, 0.005}) {
    EXPECT_NEAR(firstOf(now_s + jitter_s, jitter_s), -0.1, 1e-4) << jitter_s;
  }
  constexpr double kSet_s = 0.07;  // the clock of stamps and points is set
  now_s += kSet_s;
  for (const double jitter_s : {0.0, 0.01, -0.02}) {
    EXPECT_NEAR(firstOf(now_s + jitter_s, kSet_s + jitter_s), -0.1, 1e-4) << "after it " << jitter_s;
  }
}

TEST(SweepTiming, AbsoluteFieldThatSharesTheStampsJitterStaysAtTheStamp) {
  std::vector<float> times_s;
  SweepTiming timing(paramsWith("auto"));
  double stamp_s = 100.0;
  for (const double jitter_s : {0.0, 0.01, -0.02, 0.003, 0.0}) {
    const auto at = [&](double ago_s) { return static_cast<float>(stamp_s + jitter_s - ago_s); };
    const Sweep sweep = sweepWithField({at(0.1), at(0.05), at(0.0)}, stamp_s + jitter_s);
    EXPECT_TRUE(timing.assign(sweep, kPeriod_s, times_s, jitter_s).ok());
    EXPECT_NEAR(times_s.front(), -0.1, 1e-4) << jitter_s;
    stamp_s += kPeriod_s;
  }
}

TEST(SweepTiming, RefusesFieldsThatAreNotThisSweepsSeconds) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const struct {
    std::vector<float> field;
    double stamp_s;
    TimeField expected;
  } cases[] = {{{0.0f, 5e7f, 1e8f}, 100.0, TimeField::kBadScale},     // ns
               {{0.0f, 5e4f, 1e5f}, 100.0, TimeField::kBadScale},     // us
               {{0.0f, 50.0f, 100.0f}, 100.0, TimeField::kBadScale},  // ms
               {{1.3e9f, 1.3e9f, 1.3e9f + 128.0f}, 1.3e9, TimeField::kBadScale},
               {{1e5f, 1e5f + 0.0469f, 1e5f + 0.1016f}, 1e5, TimeField::kBadScale},  // a float's steps there are 8 ms
               {{0.0f, 0.0f, 0.0f}, 100.0, TimeField::kNoSpread},
               {{0.02f, 0.02f, 0.0205f}, 100.0, TimeField::kNoSpread},
               {{0.0f, nan, 0.1f}, 100.0, TimeField::kNotFinite},
               {{-inf, 0.0f, 0.1f}, 100.0, TimeField::kNotFinite}};
  for (const auto& c : cases) {
    std::vector<float> times_s = {1.0f};
    const TimingResult strict =
        SweepTiming(paramsWith("field")).assign(sweepWithField(c.field, c.stamp_s), 0.0, times_s);
    EXPECT_FALSE(strict.ok());
    EXPECT_TRUE(strict.guessed());
    EXPECT_EQ(strict.field, c.expected) << toString(strict.field) << " for " << c.field.back();
    EXPECT_TRUE(times_s.empty());
    const TimingResult automatic =
        SweepTiming(paramsWith("auto")).assign(sweepWithField(c.field, c.stamp_s), 0.0, times_s);
    EXPECT_TRUE(automatic.ok());
    EXPECT_EQ(automatic.source, TimingSource::kAzimuth);
    EXPECT_EQ(automatic.field, c.expected);
    EXPECT_EQ(automatic.guessed(), c.expected != TimeField::kNoSpread) << automatic.refusal;
    EXPECT_EQ(automatic.reference, StampReference::kEnd);
    for (const float t : times_s) EXPECT_TRUE(t >= -static_cast<float>(kPeriod_s) && t <= 0.0f);
  }
}

TEST(SweepTiming, FieldThatIsRequiredAndMissingIsRefused) {
  std::vector<float> times_s;
  const TimingResult result = SweepTiming(paramsWith("field")).assign(sweepAt({0.1, 0.2}), 0.0, times_s);
  EXPECT_EQ(result.field, TimeField::kAbsent);
  EXPECT_TRUE(result.guessed());
  EXPECT_FALSE(SweepTiming(paramsWith("auto")).assign(sweepAt({0.1, 0.2}), 0.0, times_s).guessed());
}

/// A revolution of a clockwise head from the rear, with times of the sweep's own from 0 on.
Sweep revolution(double stamp_s, std::size_t points = 5000) {
  std::vector<double> yaws;
  std::vector<double> turned;  // ratio of the revolution, by point
  for (std::size_t i = 0; i < points; ++i) {
    turned.push_back((static_cast<double>(i) + 0.5) / static_cast<double>(points));
    yaws.push_back(M_PI * (1.0 - 2.0 * turned.back()));
  }
  Sweep sweep = sweepAt(yaws, stamp_s);
  for (const double ratio : turned) sweep.times_s.push_back(static_cast<float>(kPeriod_s * ratio));
  return sweep;
}

TEST(SweepTiming, OfAnotherClockTheDifferencesCount) {
  for (const char* reference : {"auto", "start", "mid", "end"}) {
    SweepTiming timing(paramsWith("auto", reference));
    const double zero = reference == std::string("mid") ? 0.5 : reference == std::string("end") ? 1.0 : 0.0;
    for (int i = 0; i < 5; ++i) {
      Sweep sweep = revolution(100.0 + i * kPeriod_s + 0.02 * (i % 2));  // the stamps jitter
      sweep.time_field.origin_s = 4711.0 + i * kPeriod_s;
      std::vector<float> times_s;
      const TimingResult result = timing.assign(sweep, 0.0, times_s);
      EXPECT_EQ(result.field, TimeField::kUsed);
      EXPECT_FALSE(result.guessed());
      EXPECT_STREQ(toString(result.reference), zero == 0.0 ? "start" : reference);
      EXPECT_NEAR(times_s.front(), -zero * kPeriod_s, 1e-5);
      EXPECT_NEAR(times_s.back() - times_s.front(), kPeriod_s * (1.0 - 1.0 / 5000.0), 1e-5);
    }
  }
}

// 0.6 s off, to and fro: the stamp is wrong, and the clock is not another one for the rest of the drive.
TEST(SweepTiming, AClockIsNotLostByOneWrongStamp) {
  SweepTiming timing(paramsWith("auto"));
  std::vector<float> times_s;
  for (int i = 0; i < 6; ++i) {
    const double start_s = 1e9 + i * kPeriod_s;
    Sweep sweep = revolution(start_s + kPeriod_s + (i == 3 ? 0.6 : 0.0));  // stamped at the end
    sweep.time_field.origin_s = start_s;
    const TimingResult result = timing.assign(sweep, 0.0, times_s);
    EXPECT_EQ(result.field, TimeField::kUsed);
    EXPECT_EQ(result.reference, StampReference::kEnd) << i;
    EXPECT_NEAR(times_s.front(), -kPeriod_s, 1e-4) << i;
    EXPECT_NEAR(times_s.back(), 0.0, 1e-4) << i;
  }
}

TEST(SweepTiming, OutliersAreCountedAndHaveNoTime) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float wrong : {3e8f, -1.7e9f, nan}) {
    Sweep sweep = revolution(100.0);
    for (float& t : sweep.times_s) t -= static_cast<float>(kPeriod_s);
    for (const std::size_t i : {0u, 17u, 4999u}) sweep.times_s[i] = wrong;
    std::vector<float> times_s;
    const TimingResult result = SweepTiming(paramsWith("auto")).assign(sweep, 0.0, times_s);
    EXPECT_EQ(result.field, TimeField::kUsed);
    EXPECT_EQ(result.reference, StampReference::kEnd);
    EXPECT_EQ(result.outliers, 3u);
    for (std::size_t i = 0; i < times_s.size(); ++i) {
      const bool is_wrong = i == 0 || i == 17 || i == 4999;
      ASSERT_EQ(std::isnan(times_s[i]), is_wrong) << i;
      if (!is_wrong) {
        ASSERT_EQ(times_s[i], sweep.times_s[i]);
      }
    }
  }
}

TEST(SweepTiming, ASweepWhoseFieldFailsIsTimedAsThoseBeforeIt) {
  const struct {
    const char* name;
    void (*break_field)(Sweep&);
    TimeField found;
  } cases[] = {
      {"zeros", [](Sweep& s) { s.times_s.assign(s.size(), 0.0f); }, TimeField::kNoSpread},
      {"none", [](Sweep& s) { s.times_s.clear(); }, TimeField::kAbsent},
      {"NaN", [](Sweep& s) { s.times_s.assign(s.size(), std::numeric_limits<float>::quiet_NaN()); },
       TimeField::kNotFinite},
      {"refused", [](Sweep& s) { s.times_s.clear(), s.time_field.refused = "no unit"; }, TimeField::kBadScale},
      {"too long",
       [](Sweep& s) {
         for (float& t : s.times_s) t *= 20.0f;
       },
       TimeField::kBadScale},
  };
  for (const auto& c : cases) {
    for (const char* source : {"auto", "field"}) {
      for (const double first_s : {0.0, -kPeriod_s}) {
        SweepTiming timing(paramsWith(source));
        std::vector<float> times_s;
        for (int i = 0; i < 4; ++i) {
          Sweep sweep = revolution(100.0 + i * kPeriod_s);
          for (float& t : sweep.times_s) t += static_cast<float>(first_s);
          const std::vector<float> right = sweep.times_s;
          if (i == 2) c.break_field(sweep);
          const TimingResult result = timing.assign(sweep, 0.0, times_s);
          EXPECT_TRUE(result.ok()) << c.name;
          EXPECT_FALSE(result.guessed()) << c.name;
          EXPECT_EQ(result.field, i == 2 ? c.found : TimeField::kUsed) << c.name;
          EXPECT_EQ(result.source, i == 2 ? TimingSource::kHeld : TimingSource::kField) << c.name;
          EXPECT_EQ(result.reference, first_s == 0.0 ? StampReference::kStart : StampReference::kEnd) << c.name;
          ASSERT_EQ(times_s.size(), right.size());
          for (std::size_t k = 10; k + 10 < right.size(); ++k) ASSERT_NEAR(times_s[k], right[k], 2e-4) << c.name << k;
        }
        timing.reset();
        Sweep sweep = revolution(200.0);
        c.break_field(sweep);
        const TimingResult anew = timing.assign(sweep, 0.0, times_s);
        EXPECT_NE(anew.source, TimingSource::kHeld) << c.name;
        const bool unreadable = c.found == TimeField::kNotFinite || c.found == TimeField::kBadScale;
        EXPECT_EQ(anew.guessed(), unreadable || std::string(source) == "field") << c.name;
        EXPECT_EQ(anew.guessed(), !anew.refusal.empty());
      }
    }
  }
}

TEST(DescribeGuess, NamesTheFieldAndWhatToSet) {
  Sweep sweep = revolution(100.0);
  sweep.times_s.clear();
  sweep.time_field.name = "stamps_ms";
  sweep.time_field.refused = "its numbers span 7";
  std::vector<float> times_s;
  const TimingResult result = SweepTiming(paramsWith("auto")).assign(sweep, 0.0, times_s);
  ASSERT_TRUE(result.guessed());
  const std::string text = describeGuess(result);
  for (const char* part : {"`stamps_ms`", "its numbers span 7", "azimuth", "end", "sensor.timing.source"}) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  }
  EXPECT_EQ(text.find('\n'), std::string::npos);
}

TEST(SweepTiming, AbsentFieldOffAndEmpty) {
  std::vector<float> times_s = {1.0f};
  Sweep sweep = sweepAt({0.1, 0.2});
  EXPECT_EQ(SweepTiming(paramsWith("auto")).assign(sweep, 0.0, times_s).field, TimeField::kAbsent);
  EXPECT_EQ(times_s.size(), 2u);
  sweep.times_s = {0.0f};  // not one per point
  EXPECT_EQ(SweepTiming(paramsWith("field")).assign(sweep, 0.0, times_s).field, TimeField::kAbsent);
  EXPECT_TRUE(times_s.empty());
  times_s = {1.0f};
  EXPECT_FALSE(SweepTiming(paramsWith("none")).assign(sweep, 0.0, times_s).ok());
  EXPECT_TRUE(times_s.empty());
  EXPECT_FALSE(SweepTiming(paramsWith("auto")).assign(Sweep(), 0.0, times_s).ok());
  EXPECT_TRUE(times_s.empty());
}

TEST(SweepTiming, PeriodIsTheGivenThenTheMeasuredThenANominalOne) {
  std::vector<float> times_s;
  SweepTimingParams params = paramsWith("azimuth");
  EXPECT_EQ(SweepTiming(params).assign(sweepAt({0.0}), 0.05, times_s).period_s, kPeriod_s);
  params.sweep_period_s = 0.0;
  const TimingResult measured = SweepTiming(params).assign(sweepAt({0.0}), 0.05, times_s);
  EXPECT_TRUE(measured.period_known);
  EXPECT_EQ(measured.period_s, 0.05);
  EXPECT_NEAR(times_s[0], -0.025, 1e-6);
  const TimingResult nominal = SweepTiming(params).assign(sweepAt({0.0}), 0.0, times_s);
  EXPECT_FALSE(nominal.period_known);
  EXPECT_EQ(nominal.period_s, 0.1);
}

/// Of a revolution of `period_s`, the part from `from` to `to`, with times from the revolution's start.
Sweep partOfRevolution(double period_s, double from, double to) {
  const Sweep whole = revolution(100.0);
  Sweep part = sweepAt({});
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const double ratio = static_cast<double>(whole.times_s[i]) / kPeriod_s;
    if (ratio < from || ratio >= to) continue;
    part.points_lidar.push_back(whole.points_lidar[i]);
    part.times_s.push_back(static_cast<float>(period_s * ratio));
  }
  return part;
}

// Otherwise the first clouds of a head at 20 Hz are timed as if it turned at 10 Hz, and the vehicle seems to jump when
// the clock knows better.
TEST(SweepTiming, UntilThePeriodIsKnownTheFieldTellsIt) {
  struct Part {
    double from, to, period;  ///< in revolutions
  };
  const Part parts[] = {{0.0, 1.0, 1.0}, {0.0, 0.5, 0.5}, {0.0, 0.25, 0.25}, {0.0, 0.8, 1.0},
                        {0.0, 0.4, 1.0}, {0.6, 1.0, 1.0}, {0.5, 1.0, 1.0},   {0.38, 1.0, 1.0}};
  SweepTimingParams params = paramsWith("auto", "mid");
  params.sweep_period_s = 0.0;
  for (const double period_s : {0.05, 0.1, 0.2}) {
    for (const Part& part : parts) {
      for (const bool has_strays : {false, true}) {
        SCOPED_TRACE(std::to_string(period_s) + " " + std::to_string(part.from) + " " + std::to_string(part.to));
        Sweep sweep = partOfRevolution(period_s, part.from, part.to);
        for (std::size_t i = 7; has_strays && i < sweep.size(); i += 20)
          sweep.times_s[i] = i % 40 == 7 ? 1e9f : std::numeric_limits<float>::quiet_NaN();
        std::vector<float> times_s;
        const TimingResult result = SweepTiming(params).assign(sweep, 0.0, times_s);
        EXPECT_EQ(result.field, TimeField::kUsed);
        EXPECT_FALSE(result.period_known);
        EXPECT_NEAR(result.period_s, part.period * period_s, 5e-3 * period_s);
        EXPECT_NEAR(times_s.front(), (part.from - 0.5 * part.period) * period_s, 5e-3 * period_s);
      }
    }
  }
}

TEST(SweepTiming, TimesThatRunBackwardAreRefused) {
  SweepTiming timing(paramsWith("auto", "end"));
  const auto assign = [&](int i, bool backward, std::vector<float>& times_s) {
    Sweep sweep = revolution(100.0 + i * kPeriod_s);
    for (float& time_s : sweep.times_s) time_s = backward ? static_cast<float>(kPeriod_s) - time_s : time_s;
    return timing.assign(sweep, 0.0, times_s);
  };
  std::vector<float> right_s, times_s;
  EXPECT_EQ(assign(0, false, right_s).field, TimeField::kUsed);
  for (int i = 1; i <= 100; ++i) {
    const TimingResult result = assign(i, true, times_s);
    EXPECT_EQ(result.field, TimeField::kBackward) << i;
    EXPECT_EQ(result.source, TimingSource::kHeld) << i;
    EXPECT_FALSE(result.field_reference.has_value()) << i;
    for (std::size_t k = 50; k + 50 < times_s.size(); k += 100) ASSERT_NEAR(times_s[k], right_s[k], 1e-3) << i;
  }
  EXPECT_EQ(assign(101, true, times_s).field, TimeField::kUsed) << "the head turns that way, after all";
  EXPECT_EQ(assign(102, false, times_s).field, TimeField::kUsed) << "as the parameter says";
}

TEST(SweepTiming, RefusesBadParameters) {
  const auto broken = [](void (*change)(SweepTimingParams&)) {
    SweepTimingParams params;
    change(params);
    return params;
  };
  EXPECT_NO_THROW(validate(SweepTimingParams()));
  EXPECT_THROW(validate(broken([](SweepTimingParams& p) { p.source = "clock"; })), ParameterError);
  EXPECT_THROW(validate(broken([](SweepTimingParams& p) { p.stamp_reference = "first"; })), ParameterError);
  EXPECT_THROW(validate(broken([](SweepTimingParams& p) { p.start_azimuth_deg = 1000.0; })), ParameterError);
  EXPECT_THROW(validate(broken([](SweepTimingParams& p) { p.sweep_period_s = -0.1; })), ParameterError);
  EXPECT_THROW(validate(broken([](SweepTimingParams& p) { p.sweep_period_s = 100.0; })), ParameterError);
  EXPECT_THROW(validate(broken([](SweepTimingParams& p) { p.min_field_spread_s = 0.0; })), ParameterError);
}

}  // namespace
}  // namespace fail_aware::timing_test
