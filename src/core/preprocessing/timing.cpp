#include "core/preprocessing/timing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/geometry/degree.hpp"
#include "core/preprocessing/point_times.hpp"
#include "core/preprocessing/revolution.hpp"
#include "core/stamp_difference.hpp"
#include "point_block.hpp"

namespace fail_aware {

namespace {

constexpr double kFieldLimitUnknownPeriod_s = 0.5;
constexpr int kMostBackward = 100;  // sweeps in a row; then the head turns backward, whatever the parameters say
constexpr double kFieldLimitPeriods = 2.5;           // the field still times two revolutions in one cloud
constexpr double kCoarsestFieldResolution_s = 1e-3;  // of an absolute time in a float
constexpr double kZeroTolerance = 0.1;               // of the spread: a packet's points lie on both sides of its stamp

/// As a ratio of the sweep's period, from its start.
double positionInSweep(StampReference reference) {
  switch (reference) {
    case StampReference::kStart: return 0.0;
    case StampReference::kMid: return 0.5;
    case StampReference::kEnd: break;
  }
  return 1.0;
}

StampReference referenceFromSign(double low, double high) {
  const double tolerance = kZeroTolerance * (high - low);
  if (low >= -tolerance) return StampReference::kStart;
  return high <= tolerance ? StampReference::kEnd : StampReference::kMid;
}

/// atan on [-1, 1], minimax polynomial of degree 9, error 1.2e-5 rad.
PointBlock::Array atanUnit(const PointBlock::Array& r) {
  const PointBlock::Array r2 = r * r;
  return r * (0.999866329f + r2 * (-0.330304786f + r2 * (0.180159295f + r2 * (-0.0851563508f + r2 * 0.0208451142f))));
}

/// atan2(y, x) without branches: with r = (|y| - |x|)/(|y| + |x|), atan2(|y|, |x|) = pi/4 + atan(r).
PointBlock::Array atan2Fast(const PointBlock::Array& y, const PointBlock::Array& x) {
  const PointBlock::Array abs_x = x.abs(), abs_y = y.abs();
  const PointBlock::Array r = (abs_y - abs_x) / (abs_y + abs_x + 1e-30f);
  const PointBlock::Array sign_x = (x * 1e30f).max(-1.0f).min(1.0f);
  const PointBlock::Array sign_y = (y * 1e30f + 1.0f).max(-1.0f).min(1.0f);  // zero counts as positive
  return sign_y * (static_cast<float>(M_PI / 2.0) + sign_x * (atanUnit(r) - static_cast<float>(M_PI / 4.0)));
}

}  // namespace

std::string describeGuess(const TimingResult& timing) {
  const std::string instead = timing.ok() ? "points are timed by their azimuth, as if the stamp were the sweep's " +
                                                std::string(toString(timing.reference)) + ", which is a guess"
                                          : std::string("points are not timed");
  return "point times are refused (" + timing.refusal + "); " + instead +
         ". Correct the driver's field, or set sensor.timing.source to azimuth (or none, if the driver compensates the "
         "motion) and sensor.timing.stamp_reference to what the stamps mean";
}

void SweepTimingParams::checkRules() const {
  requireParameter(source == "auto" || source == "field" || source == "azimuth" || source == "none", "source", source,
                   "auto, field, azimuth or none");
  requireParameter(
      stamp_reference == "auto" || stamp_reference == "start" || stamp_reference == "mid" || stamp_reference == "end",
      "stamp_reference", stamp_reference, "start, mid, end or auto");
  requireParameter(sweep_period_s == 0.0 || (sweep_period_s >= kShortestPeriod_s && sweep_period_s <= kLongestPeriod_s),
                   "sweep_period_s", sweep_period_s, "0 (measured) or in [0.02, 1]");
}

void SweepTiming::reset() {
  clock_.reset();
  shared_error_s_ = 0.0;
  held_.reset();
  backward_sweeps_ = 0;
}

StampReference SweepTiming::referenceOr(StampReference automatic) const {
  if (params_.stamp_reference == "start") return StampReference::kStart;
  if (params_.stamp_reference == "mid") return StampReference::kMid;
  if (params_.stamp_reference == "end") return StampReference::kEnd;
  return automatic;
}

TimingResult SweepTiming::assign(const Sweep& sweep, double measured_period_s,
                                 std::vector<float>& times_relative_to_stamp_s, double stamp_error_s) {
  TimingResult result;
  const double known_s = params_.sweep_period_s > 0.0 ? params_.sweep_period_s : measured_period_s;
  result.period_known = known_s > 0.0;
  result.period_s = result.period_known ? known_s : kUsualPeriod_s;
  result.reference = referenceOr(StampReference::kEnd);

  if (params_.source == "none" || sweep.empty()) {
    times_relative_to_stamp_s.clear();
    return result;
  }
  if (params_.source != "azimuth") {
    result.field = assignField(sweep, stamp_error_s, result, times_relative_to_stamp_s);
    if (result.field == TimeField::kUsed) {
      result.source = TimingSource::kField;
      return result;
    }
    if (held_.apply(sweep, times_relative_to_stamp_s)) {
      result.source = TimingSource::kHeld;
      result.reference = last_reference_;
      return result;
    }
    if (params_.source == "field") {
      times_relative_to_stamp_s.clear();
      if (result.refusal.empty()) {
        result.refusal = result.field == TimeField::kAbsent
                             ? "the cloud has no times, and sensor.timing.source is field"
                             : "all times of the cloud are equal";
      }
      return result;
    }
  }
  timesByAzimuth(params_, sweep.points_lidar, positionInSweep(result.reference), result.period_s,
                 times_relative_to_stamp_s);
  result.source = TimingSource::kAzimuth;
  return result;
}

namespace {

/// Of one cloud, by its own times: of a whole revolution, or of a half, a third or a quarter of one, which begins or
/// ends at zero. A driver's first cloud may hold any other part: that of a whole revolution.
std::optional<double> cloudPeriod_s(const Sweep& sweep, const TimeRange& range) {
  constexpr double kNear = 0.03;  // of the cloud's span
  std::vector<float> times_s = sweep.times_s;
  for (float& time_s : times_s) {
    if (!range.contains(time_s)) time_s = std::numeric_limits<float>::quiet_NaN();
  }
  const double revolution_s = revolutionFromTimes(sweep.points_lidar, times_s), span_s = range.span_s();
  if (!(revolution_s > 0.0)) return std::nullopt;
  const double clouds = std::round(revolution_s / span_s);
  const double first_s = range.first_s + sweep.time_field.origin_s, last_s = first_s + span_s;
  const bool is_part = clouds >= 2.0 && clouds <= 4.0 && std::abs(clouds * span_s / revolution_s - 1.0) < kNear &&
                       std::min(std::abs(first_s), std::abs(last_s)) < kNear * span_s;
  return is_part ? revolution_s / clouds : revolution_s;
}

std::string inMs(double time_s) {
  std::string text = std::to_string(1e3 * time_s);
  return text.substr(0, text.find('.') + 2) + " ms";
}

}  // namespace

// If the first sweep shows another clock, that clock is kept. Later, a sweep that fits neither its stamp nor zero has a
// wrong stamp.
SweepTiming::Clock SweepTiming::clockOf(double first_s, double last_s, double stamp_s, double limit_s) const {
  if (clock_ == Clock::kOther) return Clock::kOther;
  const auto near = [&](double zero_s, double limit) { return first_s - zero_s >= -limit && last_s - zero_s <= limit; };
  if (near(0.0, limit_s)) return Clock::kSweep;
  // near the limit, jitter must not change the clock from sweep to sweep
  return near(stamp_s, clock_ == Clock::kStamp ? 2.0 * limit_s : limit_s) ? Clock::kStamp : Clock::kOther;
}

/// The stamp's error without what is the points' error, too: a clock of both that was set, or a driver that counts the
/// points' times from its jittering stamp. Then the points go on as before relative to the stamp, not to the time.
/// `first_s`: of the points, relative to the stamp.
double SweepTiming::jitterOf(double first_s, double stamp_error_s) {
  const double jitter_s = stamp_error_s - shared_error_s_;
  const double by_stamp_s = std::abs(first_s - last_first_s_), by_time_s = std::abs(first_s + jitter_s - last_first_s_);
  if (by_stamp_s >= by_time_s) return jitter_s;
  shared_error_s_ = stamp_error_s;
  return 0.0;
}

/// From the sweep's times to times relative to the stamp; also sets the result's references.
double SweepTiming::fieldOffset_s(const Sweep& sweep, const TimeRange& range, double limit_s, double stamp_error_s,
                                  TimingResult& result) {
  const double origin_s = sweep.time_field.origin_s;
  const Clock clock = clockOf(origin_s + range.first_s, origin_s + range.last_s, sweep.stamp_s, limit_s);
  const bool is_first = !clock_;
  if (is_first || clock != Clock::kOther) clock_ = clock;
  if (clock == Clock::kSweep) {
    const StampReference zero = referenceFromSign(range.first_s, range.last_s);
    result.field_reference = zero;
    result.reference = referenceOr(zero);
    return origin_s + (positionInSweep(zero) - positionInSweep(result.reference)) * result.period_s;
  }
  if (clock == Clock::kStamp) {
    const double stamp_offset_s = origin_s - sweep.stamp_s;
    const double offset_s = stamp_offset_s + (is_first ? 0.0 : jitterOf(range.first_s + stamp_offset_s, stamp_error_s));
    result.field_reference = referenceFromSign(range.first_s + offset_s, range.last_s + offset_s);
    result.reference = referenceOr(*result.field_reference);
    return offset_s;
  }
  if (clock_ == Clock::kOther) {
    result.reference = referenceOr(StampReference::kStart);
    return -range.first_s - positionInSweep(result.reference) * result.period_s;
  }
  result.reference = last_reference_;
  return last_first_s_ - range.first_s;
}

TimeField SweepTiming::assignField(const Sweep& sweep, double stamp_error_s, TimingResult& result,
                                   std::vector<float>& times_s) {
  const auto refuse = [&](TimeField why, const std::string& text) {
    result.refusal =
        (sweep.time_field.name.empty() ? "the sweep's times" : "field `" + sweep.time_field.name + "`") + ": " + text;
    return why;
  };
  if (!sweep.time_field.refused.empty()) return refuse(TimeField::kBadScale, sweep.time_field.refused);
  const std::size_t size = sweep.times_s.size();
  if (size != sweep.size()) return TimeField::kAbsent;
  const std::optional<TimeRange> range = rangeOfTimes(sweep.times_s, result.period_known ? result.period_s : 0.0);
  if (!range) return refuse(TimeField::kNotFinite, "more than a tenth of its values are not finite");
  if (range->span_s() < params_.min_field_spread_s) return TimeField::kNoSpread;

  const double limit = result.period_known ? kFieldLimitPeriods * result.period_s : kFieldLimitUnknownPeriod_s;
  if (range->span_s() > limit) {
    return refuse(TimeField::kBadScale, "its values span " + inMs(range->span_s()) + ", more than the " + inMs(limit) +
                                            " that a cloud may take");
  }
  const double resolution_s = std::max(std::abs(range->first_s), std::abs(range->last_s)) * 1.2e-7;
  if (resolution_s > kCoarsestFieldResolution_s) {
    return refuse(TimeField::kBadScale, "its values are too coarse: 32 bits hold them to " + inMs(resolution_s));
  }

  if (!result.period_known) result.period_s = cloudPeriod_s(sweep, *range).value_or(kUsualPeriod_s);
  const double offset_s = fieldOffset_s(sweep, *range, limit, stamp_error_s, result);
  times_s.resize(size);
  for (std::size_t i = 0; i < size; ++i) {
    const bool usable = range->contains(sweep.times_s[i]);
    times_s[i] = usable ? static_cast<float>(sweep.times_s[i] + offset_s) : std::numeric_limits<float>::quiet_NaN();
    if (!usable) ++result.outliers;
  }
  const std::optional<HeldTiming::Head> head =
      HeldTiming::headOf(sweep, times_s, range->first_s + offset_s, result.period_s);
  if (head && held_.turnsAgainst(*head) && head->clockwise != params_.clockwise && backward_sweeps_ < kMostBackward) {
    ++backward_sweeps_;
    result.field_reference.reset();  // what a field says that is not used
    result.outliers = 0;
    return refuse(TimeField::kBackward, "its values run against the head's sense of rotation");
  }
  backward_sweeps_ = 0;
  last_first_s_ = range->first_s + offset_s;
  last_reference_ = result.reference;
  held_.keep(head);
  return TimeField::kUsed;
}

void timesByAzimuth(const SweepTimingParams& params, const std::vector<Eigen::Vector3f>& points_lidar,
                    double zero_position, double period_s, std::vector<float>& times_s) {
  // Rotated (and mirrored, for a counter-clockwise head) so that the sweep runs from yaw pi down to -pi.
  const double turn = M_PI - params.start_azimuth_deg * kDegree;
  const float c = static_cast<float>(std::cos(turn)), s = static_cast<float>(std::sin(turn));
  const float mirror = params.clockwise ? 1.0f : -1.0f;
  const float period = static_cast<float>(period_s);
  const float zero = static_cast<float>(zero_position);
  const float per_rad = static_cast<float>(0.5 / M_PI);

  times_s.resize(points_lidar.size());
  PointBlock p;
  forEachBlock(points_lidar.size(), [&](std::size_t first, std::size_t count) {
    p.load(&points_lidar[first], count);
    const PointBlock::Array x = c * p.x - s * p.y;
    const PointBlock::Array y = mirror * (s * p.x + c * p.y);
    const PointBlock::Array fraction = 0.5f - per_rad * atan2Fast(y, x);
    for (std::size_t i = 0; i < count; ++i) {
      const float f = fraction.data()[i];
      const float bounded = f > 0.0f ? (f < 1.0f ? f : 1.0f) : 0.0f;
      times_s[first + i] = (bounded - zero) * period;
    }
  });
}

}  // namespace fail_aware
