#include "core/preprocessing/sweep_seam.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/geometry/degree.hpp"

namespace fail_aware {

namespace {

constexpr std::size_t kBlocks = 72;
constexpr std::size_t kLooks = 20;            // per block
constexpr std::size_t kFirstRatio = 720;      // the first points: half a degree of the revolution
constexpr double kMinLength = 0.8;            // of a block's mean direction: 1 if all its points lie in one direction
constexpr double kLargestStep_deg = 60.0;     // between blocks: larger if there are no returns in between
constexpr double kMinRevolution_deg = 300.0;  // from the first block to the last; the ends may hold no points
constexpr double kMaxRevolution_deg = 400.0;
constexpr std::size_t kMaxStrange = 7;  // blocks, a tenth: points near the head may lie in any direction

double wrapped_deg(double angle_deg) { return std::remainder(angle_deg, 360.0); }

/// Mean of the points' horizontal directions, [first, last); its length is 1 if they are all equal.
Eigen::Vector2d meanDirection(const std::vector<Eigen::Vector3f>& points, std::size_t first, std::size_t last) {
  const std::size_t step = std::max<std::size_t>(1, (last - first) / kLooks);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double count = 0.0;
  for (std::size_t i = first; i < last; i += step) {
    const Eigen::Vector2d p = points[i].head<2>().cast<double>();
    const double range_m = p.norm();
    if (!(range_m > 0.0)) continue;
    sum += p / range_m;
    count += 1.0;
  }
  return count > 0.0 ? Eigen::Vector2d(sum / count) : Eigen::Vector2d::Zero().eval();
}

double azimuth_deg(const Eigen::Vector2d& direction) { return std::atan2(direction.y(), direction.x()) / kDegree; }

}  // namespace

std::optional<SweepSeam> findSweepSeam(const std::vector<Eigen::Vector3f>& points_lidar) {
  const std::size_t size = points_lidar.size();
  if (size < kBlocks * kLooks) return std::nullopt;
  std::vector<double> azimuths_deg;
  std::size_t strange = 0;
  for (std::size_t block = 0; block < kBlocks; ++block) {
    const Eigen::Vector2d mean = meanDirection(points_lidar, block * size / kBlocks, (block + 1) * size / kBlocks);
    if (mean.norm() < kMinLength) {
      ++strange;
    } else {
      azimuths_deg.push_back(azimuth_deg(mean));
    }
  }
  double turned_deg = 0.0;
  std::size_t backward = 0;
  for (std::size_t i = 1; i < azimuths_deg.size(); ++i)
    turned_deg += wrapped_deg(azimuths_deg[i] - azimuths_deg[i - 1]);
  for (std::size_t i = 1; i < azimuths_deg.size(); ++i) {
    const double step_deg = wrapped_deg(azimuths_deg[i] - azimuths_deg[i - 1]);
    if (std::abs(step_deg) > kLargestStep_deg) ++strange;
    if (step_deg * turned_deg < 0.0) ++backward;
  }
  if (strange + backward > kMaxStrange || std::abs(turned_deg) < kMinRevolution_deg ||
      std::abs(turned_deg) > kMaxRevolution_deg) {
    return std::nullopt;
  }
  const Eigen::Vector2d first = meanDirection(points_lidar, 0, std::max(kLooks, size / kFirstRatio));
  if (first.norm() < kMinLength) return std::nullopt;
  return SweepSeam{azimuth_deg(first), turned_deg < 0.0};
}

void SweepSeamCheck::observe(const SweepSeam& seam) {
  seams_.push_back(seam);
  if (seams_.size() > kSweepsKept) seams_.pop_front();
}

bool SweepSeamCheck::contradicts(const SweepSeam& seam) const {
  return seam.clockwise != params_.clockwise ||
         std::abs(wrapped_deg(seam.start_azimuth_deg - params_.start_azimuth_deg)) > kTolerance_deg;
}

bool SweepSeamCheck::contradicted() const {
  const auto count =
      std::count_if(seams_.begin(), seams_.end(), [this](const SweepSeam& seam) { return contradicts(seam); });
  return seams_.size() >= kSweepsNeeded && 2 * static_cast<std::size_t>(count) > seams_.size();
}

std::string SweepSeamCheck::contradiction() const {
  if (!contradicted()) return "";
  std::vector<SweepSeam> contradicting;
  for (const SweepSeam& seam : seams_) {
    if (contradicts(seam)) contradicting.push_back(seam);
  }
  // the median, relative to the newest azimuth
  const double newest_deg = contradicting.back().start_azimuth_deg;
  const auto middle = contradicting.begin() + static_cast<std::ptrdiff_t>(contradicting.size() / 2);
  std::nth_element(contradicting.begin(), middle, contradicting.end(), [&](const SweepSeam& a, const SweepSeam& b) {
    return wrapped_deg(a.start_azimuth_deg - newest_deg) < wrapped_deg(b.start_azimuth_deg - newest_deg);
  });
  char text[320];
  const auto turn = [](bool clockwise) { return clockwise ? "clockwise" : "counter-clockwise"; };
  std::snprintf(text, sizeof text,
                "the points' times are taken from their azimuth, but the clouds begin at %.0f deg and turn %s, and "
                "sensor.timing says start_azimuth_deg %.0f, %s: set start_azimuth_deg and clockwise, or the driver's "
                "cut angle",
                middle->start_azimuth_deg, turn(middle->clockwise), wrapped_deg(params_.start_azimuth_deg),
                turn(params_.clockwise));
  return text;
}

}  // namespace fail_aware
