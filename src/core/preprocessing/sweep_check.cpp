#include "core/preprocessing/sweep_check.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string_view>

#include "core/preprocessing/azimuth_coverage.hpp"

namespace fail_aware {

namespace {

constexpr std::size_t kComparedPoints = 20000;
constexpr double kFarRatio = 0.02;  // of the points: beyond the range of view

void look(const std::vector<Eigen::Vector3f>& points, SweepFindings& findings) {
  // An odd stride visits all beams of a column of 64 or 128; so does any stride without a common factor.
  const std::size_t stride = (points.size() / kComparedPoints) | 1u;
  std::vector<float> squares_m2;
  squares_m2.reserve(points.size() / stride + 1);
  for (std::size_t i = 0; i < points.size(); i += stride) squares_m2.push_back(points[i].squaredNorm());
  const auto far =
      squares_m2.end() - 1 - static_cast<std::ptrdiff_t>(kFarRatio * static_cast<double>(squares_m2.size()));
  std::nth_element(squares_m2.begin(), far, squares_m2.end());
  findings.azimuth_coverage = azimuthCoverage(points, stride);
  findings.view_range_m = std::sqrt(static_cast<double>(*far));
}

std::size_t fingerprint(const std::vector<Eigen::Vector3f>& points) {
  const auto* const bytes = reinterpret_cast<const char*>(points.data());
  return std::hash<std::string_view>()({bytes, points.size() * sizeof(Eigen::Vector3f)});
}

}  // namespace

const char* describeIncomplete() {
  return "the sweep is incomplete: part of the revolution is missing. If the driver publishes half a revolution (or "
         "less) a cloud, or the lidar does not look all around, set sensor.check.min_azimuth_coverage below what "
         "its clouds cover (/diagnostics: azimuth coverage)";
}

SweepFindings SweepCheck::check(const Sweep& sweep) {
  SweepFindings findings;
  if (last_stamp_s_) {
    const double since_last_s = sweep.stamp_s - *last_stamp_s_;
    findings.time_jump = since_last_s < 0.0 || since_last_s > params_.max_gap_s;
  }
  last_stamp_s_ = sweep.stamp_s;
  if (sweep.empty()) {
    last_fingerprint_.reset();
    repetitions_ = 0;
    return findings;
  }
  look(sweep.points_lidar, findings);
  findings.incomplete = findings.azimuth_coverage < params_.min_azimuth_coverage;
  findings.partial_start = findings.incomplete && !any_;
  any_ = true;
  findings.low_visibility = findings.view_range_m < params_.min_view_range_m;
  const std::size_t print = fingerprint(sweep.points_lidar);
  repetitions_ = last_fingerprint_ == print ? repetitions_ + 1 : 0;
  last_fingerprint_ = print;
  findings.repetitions = repetitions_;
  findings.repeats = params_.frozen_sweeps > 0 && repetitions_ > 0;
  findings.frozen = params_.frozen_sweeps > 0 && repetitions_ >= params_.frozen_sweeps;
  return findings;
}

}  // namespace fail_aware
