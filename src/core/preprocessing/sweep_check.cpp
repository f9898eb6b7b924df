#include "core/preprocessing/sweep_check.hpp"

#include <cstring>

#include "core/preprocessing/azimuth_coverage.hpp"

namespace fail_aware {

namespace {

constexpr std::size_t kComparedPoints = 20000;

void look(const std::vector<Eigen::Vector3f>& points, double visible_range_m, SweepFindings& findings) {
  const auto far = static_cast<float>(visible_range_m * visible_range_m);
  // An odd stride visits all beams of a column of 64 or 128; so does any stride without a common factor.
  const std::size_t stride = (points.size() / kComparedPoints) | 1u;
  std::size_t looked_at = 0, beyond = 0;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    if (points[i].squaredNorm() > far) ++beyond;
    ++looked_at;
  }
  findings.azimuth_coverage = azimuthCoverage(points, stride);
  findings.far_ratio = static_cast<double>(beyond) / static_cast<double>(looked_at);
}

// 64-bit multiplicative hash over the bits of all coordinates.
std::uint64_t fingerprint(const std::vector<Eigen::Vector3f>& points) {
  std::uint64_t hash = 0x9e3779b97f4a7c15u + points.size();
  for (const Eigen::Vector3f& p : points) {
    std::uint32_t bits[3];
    std::memcpy(bits, p.data(), sizeof bits);
    const std::uint64_t word = (static_cast<std::uint64_t>(bits[0]) << 32 | bits[1]) ^ (bits[2] * 0xff51afd7ed558ccdu);
    hash = (hash ^ word) * 0xc4ceb9fe1a85ec53u;
    hash ^= hash >> 29;
  }
  return hash;
}

}  // namespace

const char* describeIncomplete() {
  return "the sweep is incomplete: part of the revolution is missing. If the driver publishes half a revolution (or "
         "less) a cloud, or the lidar does not look all around, set sensor.check.min_azimuth_coverage below the share "
         "that its clouds cover (/diagnostics: azimuth coverage)";
}

void SweepCheck::reset() {
  last_stamp_s_.reset();
  last_fingerprint_.reset();
  repetitions_ = 0;
  any_ = false;
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
  look(sweep.points_lidar, params_.visible_range_m, findings);
  findings.incomplete = findings.azimuth_coverage < params_.min_azimuth_coverage;
  findings.partial_start = findings.incomplete && !any_;
  any_ = true;
  findings.low_visibility = findings.far_ratio < params_.min_far_ratio;
  const std::uint64_t print = fingerprint(sweep.points_lidar);
  repetitions_ = last_fingerprint_ == print ? repetitions_ + 1 : 0;
  last_fingerprint_ = print;
  findings.repetitions = repetitions_;
  findings.repeats = params_.frozen_sweeps > 0 && repetitions_ > 0;
  findings.frozen = params_.frozen_sweeps > 0 && repetitions_ >= params_.frozen_sweeps;
  return findings;
}

}  // namespace fail_aware
