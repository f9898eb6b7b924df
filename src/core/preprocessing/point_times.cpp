#include "core/preprocessing/point_times.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/stamp_difference.hpp"

namespace fail_aware {

namespace {

constexpr std::size_t kSample = 2000;       // number of values that the range is estimated from
constexpr double kSoundRatio = 0.9;         // least ratio of the values that are times
constexpr double kShortestSweep_s = 0.018;  // kSoundRatio of kShortestPeriod_s
constexpr double kCoarsestStep_s = 1e-3;
constexpr double kLargestOwnTime_s = 2.0;  // times within a sweep are smaller, those of a clock larger
constexpr std::size_t kStragglers = 1000;  // one point in this many, at each end
constexpr double kSlack = 0.02;            // distance of an isolated straggler, as a ratio of the span
constexpr double kPeriodsInCloud = 1.25;   // a revolution, plus what a driver adds to it

struct Unit {
  const char* name;
  double seconds;
};
constexpr Unit kUnits[] = {{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}};

/// Sorted finite values at an odd stride (a column has an even number of beams), and the number of values read.
struct Sample {
  std::vector<double> sorted;
  std::size_t looked_at = 0;
};

template <class Number>
Sample sampleOf(const std::vector<Number>& values) {
  Sample sample;
  sample.sorted.reserve(kSample + 1);
  const std::size_t stride = (values.size() / kSample) | 1u;
  for (std::size_t i = 0; i < values.size(); i += stride, ++sample.looked_at) {
    if (std::isfinite(values[i])) sample.sorted.push_back(static_cast<double>(values[i]));
  }
  std::sort(sample.sorted.begin(), sample.sorted.end());
  return sample;
}

struct Interval {
  double low = 0.0, high = 0.0;
};

/// The shortest interval that holds kSoundRatio of the values read.
std::optional<Interval> coreOf(const Sample& sample) {
  const auto needed = static_cast<std::size_t>(std::ceil(kSoundRatio * static_cast<double>(sample.looked_at)));
  const std::vector<double>& v = sample.sorted;
  if (needed == 0 || v.size() < needed) return std::nullopt;
  std::size_t best = 0;
  for (std::size_t i = 1; i + needed <= v.size(); ++i) {
    if (v[i + needed - 1] - v[i] < v[best + needed - 1] - v[best]) best = i;
  }
  return Interval{v[best], v[best + needed - 1]};
}

double stepOf(TimeNumber type, double largest) {
  switch (type) {
    case TimeNumber::kFloat32: return largest * 1.2e-7;
    case TimeNumber::kFloat64: return largest * 2.3e-16;
    case TimeNumber::kInteger: break;
  }
  return 1.0;
}

std::string inShort(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", number);
  return text;
}

/// nullptr: in no unit the span is that of a sweep.
const Unit* unitFor(double span, TimeNumber type) {
  for (const Unit& unit : kUnits) {
    if (span * unit.seconds >= kShortestSweep_s && span * unit.seconds <= kLongestPeriod_s) return &unit;
  }
  const Unit& usual = kUnits[type == TimeNumber::kInteger ? 3 : 0];
  return span * usual.seconds < kShortestSweep_s ? &usual : nullptr;
}

}  // namespace

bool readPointTimes(const std::vector<double>& numbers, TimeNumber type, const std::string& name, Sweep& sweep) {
  TimeFieldSource& field = sweep.time_field;
  field = TimeFieldSource();
  field.name = name;
  sweep.times_s.clear();
  const std::optional<Interval> core = coreOf(sampleOf(numbers));
  if (!core) {
    field.refused = "more than a tenth of its numbers are not finite";
    return false;
  }
  const double span = core->high - core->low;
  const double largest = std::max(std::abs(core->low), std::abs(core->high));
  const Unit* unit = unitFor(span, type);
  if (unit == nullptr) {
    field.refused = "its numbers span " + inShort(span) + ", in no unit (s, ms, us, ns) a sweep of 0.02 to 1 s";
    return false;
  }
  // if all values are equal, the driver does not fill the field
  if (span > 0.0 && stepOf(type, largest) * unit->seconds > kCoarsestStep_s) {
    field.refused = "its numbers are too coarse for their size (" + inShort(largest) + " " + unit->name + ")";
    return false;
  }
  field.unit = unit->name;
  const double origin = largest * unit->seconds > kLargestOwnTime_s ? core->low : 0.0;
  field.origin_s = origin * unit->seconds;
  sweep.times_s.resize(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    sweep.times_s[i] = static_cast<float>((numbers[i] - origin) * unit->seconds);
  }
  return span > 0.0;
}

std::optional<TimeRange> rangeOfTimes(const std::vector<float>& times_s, double period_s) {
  const Sample sample = sampleOf(times_s);
  const std::optional<Interval> core = coreOf(sample);
  if (!core) return std::nullopt;
  const double span_s = core->high - core->low;
  const double rest_s = period_s > 0.0 ? kPeriodsInCloud * period_s - span_s : span_s;
  const double margin_s = std::max(0.1 * span_s, rest_s);
  TimeRange range;
  range.lowest_s = core->low - margin_s;
  range.highest_s = core->high + margin_s;

  const auto begin = std::lower_bound(sample.sorted.begin(), sample.sorted.end(), range.lowest_s);
  const auto end = std::upper_bound(begin, sample.sorted.end(), range.highest_s);
  const auto stragglers = (end - begin) / static_cast<std::ptrdiff_t>(kStragglers);
  const double low_s = *(begin + stragglers), high_s = *(end - 1 - stragglers);
  const double slack_s = kSlack * (high_s - low_s);
  const auto from = static_cast<float>(low_s - slack_s), to = static_cast<float>(high_s + slack_s);
  auto first = static_cast<float>(low_s), last = static_cast<float>(high_s);
  for (const float time_s : times_s) {  // both comparisons are false for NaN
    if (time_s >= from && time_s < first) first = time_s;
    if (time_s <= to && time_s > last) last = time_s;
  }
  range.first_s = first;
  range.last_s = last;
  return range;
}

}  // namespace fail_aware
