#include "core/preprocessing/revolution.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/geometry/rotation.hpp"

namespace fail_aware {

namespace {

constexpr std::size_t kUsedPoints = 4000;
constexpr std::size_t kBins = 36;
constexpr std::size_t kLeastBins = 12;
constexpr int kLeastPoints = 5;  // per bin
// of the bin's directions: the beams of one firing look in nearly the same direction
constexpr double kLeastResultant = 0.8;
constexpr double kUnsteady = 0.02;  // standard deviation from the line, in revolutions
constexpr float kOutside = 0.02f;   // ratio of the times dropped at each end: single wrong times

struct Bin {
  double cos_sum = 0.0, sin_sum = 0.0, time_sum_s = 0.0;
  int points = 0;
};

struct Line {
  double slope = 0.0, deviation = 0.0;
};

Line fitLine(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<Eigen::Index>(x.size());
  const Eigen::Map<const Eigen::ArrayXd> xs(x.data(), n), ys(y.data(), n);
  const Eigen::ArrayXd dx = xs - xs.mean(), dy = ys - ys.mean();
  const double slope = (dx * dy).sum() / dx.square().sum();
  return {slope, std::sqrt((dy - slope * dx).square().mean())};
}

}  // namespace

double revolutionFromTimes(const std::vector<Eigen::Vector3f>& points_lidar, const std::vector<float>& times_s) {
  if (times_s.size() != points_lidar.size() || points_lidar.empty()) return 0.0;
  const std::size_t stride = (points_lidar.size() / kUsedPoints) | 1u;
  std::vector<float> sorted_s;
  for (std::size_t i = 0; i < times_s.size(); i += stride) {
    if (std::isfinite(times_s[i])) sorted_s.push_back(times_s[i]);
  }
  if (sorted_s.empty()) return 0.0;
  std::sort(sorted_s.begin(), sorted_s.end());
  const auto outside = static_cast<std::size_t>(kOutside * static_cast<float>(sorted_s.size()));
  const float begin_s = sorted_s[outside], end_s = sorted_s[sorted_s.size() - 1 - outside];
  if (!(end_s > begin_s)) return 0.0;

  std::array<Bin, kBins> bins{};
  for (std::size_t i = 0; i < times_s.size(); i += stride) {
    const float position = (times_s[i] - begin_s) / (end_s - begin_s);
    const double x = points_lidar[i].x(), y = points_lidar[i].y(), range = std::hypot(x, y);
    if (!(position >= 0.0f && position < 1.0f) || !(range > 0.0)) continue;
    Bin& bin = bins[static_cast<std::size_t>(position * kBins)];
    bin.cos_sum += x / range;
    bin.sin_sum += y / range;
    bin.time_sum_s += static_cast<double>(times_s[i] - begin_s);
    ++bin.points;
  }
  std::vector<double> at_s, azimuths_rad;
  for (const Bin& bin : bins) {
    if (bin.points < kLeastPoints || std::hypot(bin.cos_sum, bin.sin_sum) < kLeastResultant * bin.points) continue;
    const double azimuth_rad = std::atan2(bin.sin_sum, bin.cos_sum);
    const double last_rad = azimuths_rad.empty() ? azimuth_rad : azimuths_rad.back();
    at_s.push_back(bin.time_sum_s / bin.points);
    azimuths_rad.push_back(last_rad + wrapAngle(azimuth_rad - last_rad));
  }
  if (at_s.size() < kLeastBins) return 0.0;
  const Line line = fitLine(at_s, azimuths_rad);
  if (!(std::abs(line.slope) > 0.0) || line.deviation > kUnsteady * 2.0 * M_PI) return 0.0;
  return 2.0 * M_PI / std::abs(line.slope);
}

}  // namespace fail_aware
