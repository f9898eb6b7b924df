#include "fail_aware_lidar_odometry/core/sweep/timing.hpp"

#include <algorithm>
#include <cmath>

#include "fail_aware_lidar_odometry/core/geometry/degree.hpp"
#include "fail_aware_lidar_odometry/core/parameters/check.hpp"
#include "fail_aware_lidar_odometry/core/sweep/stamp_difference.hpp"
#include "point_block.hpp"

namespace fail_aware {

namespace {

constexpr double kShortestPeriod_s = 0.02;   // 50 Hz: no head that turns faster is known
constexpr double kFieldLimitUnknownPeriod_s = 0.5;
constexpr double kFieldLimitPeriods = 2.5;           // two revolutions in one cloud are still timed by their field
constexpr double kCoarsestFieldResolution_s = 1e-3;  // an absolute time in a float
constexpr double kZeroTolerance = 0.1;               // of the spread: a packet's points lie to both sides of its stamp

/// Of the sweep's period, counted from its start.
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

/// atan on [-1, 1], minimax of degree 9, error 1.2e-5 rad.
PointBlock::Array atanUnit(const PointBlock::Array& r) {
  const PointBlock::Array r2 = r * r;
  return r * (0.999866329f + r2 * (-0.330304786f + r2 * (0.180159295f + r2 * (-0.0851563508f + r2 * 0.0208451142f))));
}

/// atan2(y, x) without a branch: with r = (|y| - |x|)/(|y| + |x|), atan2(|y|, |x|) = pi/4 + atan(r).
PointBlock::Array atan2Fast(const PointBlock::Array& y, const PointBlock::Array& x) {
  const PointBlock::Array abs_x = x.abs(), abs_y = y.abs();
  const PointBlock::Array r = (abs_y - abs_x) / (abs_y + abs_x + 1e-30f);
  const PointBlock::Array sign_x = (x * 1e30f).max(-1.0f).min(1.0f);
  const PointBlock::Array sign_y = (y * 1e30f + 1.0f).max(-1.0f).min(1.0f);  // zero counts as positive
  return sign_y * (static_cast<float>(M_PI / 2.0) + sign_x * (atanUnit(r) - static_cast<float>(M_PI / 4.0)));
}

}  // namespace

const char* toString(TimingSource source) {
  switch (source) {
    case TimingSource::kNone: return "none";
    case TimingSource::kField: return "field";
    case TimingSource::kAzimuth: return "azimuth";
  }
  return "unknown";
}

const char* toString(StampReference reference) {
  switch (reference) {
    case StampReference::kStart: return "start";
    case StampReference::kMid: return "mid";
    case StampReference::kEnd: return "end";
  }
  return "unknown";
}

const char* toString(TimingStatus status) {
  switch (status) {
    case TimingStatus::kOk: return "ok";
    case TimingStatus::kOff: return "off";
    case TimingStatus::kEmptySweep: return "empty_sweep";
    case TimingStatus::kNoField: return "no_field";
  }
  return "unknown";
}

const char* toString(TimeField field) {
  switch (field) {
    case TimeField::kNotRead: return "not_read";
    case TimeField::kUsed: return "used";
    case TimeField::kAbsent: return "absent";
    case TimeField::kNotFinite: return "not_finite";
    case TimeField::kNoSpread: return "no_spread";
    case TimeField::kBadScale: return "bad_scale";
  }
  return "unknown";
}

void SweepTimingParams::validate() const {
  requireParameter(source == "auto" || source == "field" || source == "azimuth" || source == "none", "source", source,
                   "auto, field, azimuth or none");
  requireParameter(
      stamp_reference == "auto" || stamp_reference == "start" || stamp_reference == "mid" || stamp_reference == "end",
      "stamp_reference", stamp_reference, "start, mid, end or auto");
  requireWithin("start_azimuth_deg", start_azimuth_deg, -360.0, 360.0);
  requireParameter(sweep_period_s == 0.0 || (sweep_period_s >= kShortestPeriod_s && sweep_period_s <= kLongestPeriod_s),
                   "sweep_period_s", sweep_period_s, "0 (measured) or in [0.02, 1]");
  requirePositive("min_field_spread_s", min_field_spread_s);
}

SweepTiming::SweepTiming(const Params& params) : params_(params) { params_.validate(); }

StampReference SweepTiming::referenceOr(StampReference automatic) const {
  if (params_.stamp_reference == "start") return StampReference::kStart;
  if (params_.stamp_reference == "mid") return StampReference::kMid;
  if (params_.stamp_reference == "end") return StampReference::kEnd;
  return automatic;
}

TimingResult SweepTiming::assign(const Sweep& sweep, double measured_period_s,
                                 std::vector<float>& times_relative_to_stamp_s) const {
  TimingResult result;
  result.period_s = kUsualPeriod_s;
  if (params_.sweep_period_s > 0.0) {
    result.period_s = params_.sweep_period_s;
    result.period_known = true;
  } else if (measured_period_s > 0.0) {
    result.period_s = measured_period_s;
    result.period_known = true;
  }
  result.reference = referenceOr(StampReference::kEnd);

  if (params_.source == "none" || sweep.empty()) {
    times_relative_to_stamp_s.clear();
    result.status = sweep.empty() ? TimingStatus::kEmptySweep : TimingStatus::kOff;
    return result;
  }
  if (params_.source != "azimuth") {
    result.field = assignField(sweep, result, times_relative_to_stamp_s);
    if (result.field == TimeField::kUsed) {
      result.status = TimingStatus::kOk;
      result.source = TimingSource::kField;
      return result;
    }
    if (params_.source == "field") {
      times_relative_to_stamp_s.clear();
      result.status = TimingStatus::kNoField;
      return result;
    }
  }
  timesByAzimuth(params_, sweep.points_lidar, positionInSweep(result.reference), result.period_s,
                 times_relative_to_stamp_s);
  result.status = TimingStatus::kOk;
  result.source = TimingSource::kAzimuth;
  return result;
}

TimeField SweepTiming::assignField(const Sweep& sweep, TimingResult& result, std::vector<float>& times_s) const {
  const std::size_t size = sweep.times_s.size();
  if (size != sweep.size()) return TimeField::kAbsent;
  const Eigen::Map<const Eigen::ArrayXf> field(sweep.times_s.data(), static_cast<Eigen::Index>(size));
  if (!field.allFinite()) return TimeField::kNotFinite;
  const double low = field.minCoeff(), high = field.maxCoeff();
  if (high - low < params_.min_field_spread_s) return TimeField::kNoSpread;

  const double limit = result.period_known ? kFieldLimitPeriods * result.period_s : kFieldLimitUnknownPeriod_s;
  if (high - low > limit) return TimeField::kBadScale;

  double offset = 0.0;
  if (low >= -limit && high <= limit) {
    const StampReference zero = referenceFromSign(low, high);
    result.field_reference = zero;
    result.reference = referenceOr(zero);
    offset = (positionInSweep(zero) - positionInSweep(result.reference)) * result.period_s;
  } else {
    const double resolution = std::max(std::abs(low), std::abs(high)) * 1.2e-7;
    const bool of_this_sweep = low - sweep.stamp_s >= -limit && high - sweep.stamp_s <= limit;
    if (!of_this_sweep || resolution > kCoarsestFieldResolution_s) return TimeField::kBadScale;
    result.field_reference = referenceFromSign(low - sweep.stamp_s, high - sweep.stamp_s);
    result.reference = referenceOr(*result.field_reference);
    offset = -sweep.stamp_s;
  }
  times_s.resize(size);
  for (std::size_t i = 0; i < size; ++i) times_s[i] = static_cast<float>(sweep.times_s[i] + offset);
  return TimeField::kUsed;
}

void timesByAzimuth(const SweepTimingParams& params, const std::vector<Eigen::Vector3f>& points_lidar,
                    double zero_position, double period_s, std::vector<float>& times_s) {
  // Turned (and mirrored, for a counter-clockwise head) so that the sweep runs from yaw pi down to -pi.
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
